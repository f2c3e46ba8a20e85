// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/task/task.hpp>
#include <segue/task_host/task_host.hpp>

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <thread>

namespace segue::task_host::detail {

/// Tells a listener which states tasks have entered by themselves, on a thread of its own. note() is
/// real-time safe, since components change their state in updates. Several changes of one task that come
/// quickly are told one after the other, before those of the next task.
class TaskEvents {
 public:
  using Listener = std::function<void(const TaskEvent&)>;

  /// The changes of one task that have not been told yet.
  class Source {
   public:
    Source(model::TaskId id, std::weak_ptr<task::Task> task) : id_(std::move(id)), task_(std::move(task)) {}

   private:
    friend class TaskEvents;
    void add(TaskState state) noexcept;

    const model::TaskId id_;
    const std::weak_ptr<task::Task> task_;
    /// One byte for each state, the latest in the lowest byte: its number + 1. It holds the latest eight;
    /// older ones are forgotten. A1: note() releases a state, take() acquires it.
    std::atomic<std::uint64_t> states_{0};
    /// A2: acquire-release on both sides. Whoever sets it alone writes self_ and next_; take() has read both
    /// before it clears it. note() adds a state before, so whoever finds it set knows that take() sees that.
    std::atomic<bool> queued_{false};
    std::shared_ptr<Source> self_;  ///< keeps it while it is queued
    Source* next_ = nullptr;
  };

  TaskEvents() = default;
  TaskEvents(const TaskEvents&) = delete;
  TaskEvents& operator=(const TaskEvents&) = delete;
  ~TaskEvents() { set_listener({}); }

  /// The task of `source` has entered a state. One thread at a time for each source. Real-time safe.
  void note(const std::shared_ptr<Source>& source, TaskState state) noexcept;

  /// Replaces the listener; an empty one ends the thread. No call of the previous listener is in progress
  /// when this returns, and nothing that was noted before is told to the new one. Must not be called by a
  /// listener.
  void set_listener(Listener listener);

 private:
  void run();
  /// Takes all that is queued and calls `handle` with each source and its states, oldest first.
  void take(const std::function<void(const Source&, std::uint64_t states)>& handle);
  void tell(const Source& source, std::uint64_t states) const;

  Mutex setting_;      ///< protects thread_ and listener_: one set_listener() at a time
  Listener listener_;  ///< only changed while there is no thread
  std::thread thread_;
  std::atomic<bool> stop_{false};  ///< relaxed: published by A4, or by the start of the thread
  /// A stack. A3: whoever sets Source::queued_ pushes the source (release); take() acquires the whole stack.
  std::atomic<Source*> queued_{nullptr};
  /// A4: raised (release) after a push or stop_; the thread reads it (acquire) before it looks for these, so
  /// it does not sleep over a source.
  std::atomic<std::uint32_t> rings_{0};
};

}  // namespace segue::task_host::detail

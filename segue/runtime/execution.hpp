// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/host/task_host.hpp>
#include <segue/model/transition.hpp>
#include <segue/runtime/runtime.hpp>

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace segue::runtime::detail {

/// Carries out actions one after the other, in a thread of its own: a hook that never returns then costs that
/// thread, not the runtime. The first failure ends it.
class Execution {
 public:
  /// Called after every action that was carried out, in the execution's thread.
  using Progress = std::function<void(const ActionRecord& record)>;

  Execution(host::TaskHost& host, const std::vector<model::Action>& actions, Duration action_deadline,
            Progress progress);
  /// Waits for the action in progress, however long it takes.
  ~Execution();
  Execution(const Execution&) = delete;
  Execution& operator=(const Execution&) = delete;

  /// Until all actions are done, one has failed, or one is overdue. An overdue action counts as failed
  /// (DeadlineExceeded) unless the host shows that it took effect; its thread is left to itself.
  void wait();
  /// No further action begins.
  void cancel();
  /// Whether the thread has ended, so that the destructor does not wait.
  [[nodiscard]] bool ended() const;

  /// One record per action, in order. The first error among them is why the execution ended early.
  [[nodiscard]] std::vector<ActionRecord> records() const;

 private:
  void run();
  /// False where no further action may begin.
  bool begin(std::size_t index);
  bool finish(std::size_t index, std::optional<Error> error, TimePoint started);
  /// Gives the action up; false where it has just ended by itself.
  bool abandon(std::size_t index);

  host::TaskHost& host_;
  const Duration action_deadline_;
  const Progress progress_;
  const TimePoint started_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<ActionRecord> records_;
  std::size_t current_ = 0;
  TimePoint due_;  ///< of the current action
  bool cancelled_ = false;
  bool ended_ = false;
  std::thread thread_;
};

/// Whether the effect of an action can be seen in what the host observes. ApplyConfig and CallOperation leave
/// nothing to be seen for certain: false.
bool took_effect(const model::Action& action, const model::Network& observed);

}  // namespace segue::runtime::detail

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task/sample.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

namespace segue::task {

class Executor;

/// Notified when a new sample waits at an input port.
class SampleListener {
 public:
  virtual void sample_arrived() noexcept = 0;
  /// The executor on which sample_arrived() makes something run.
  [[nodiscard]] virtual Executor& runner() noexcept = 0;

 protected:
  ~SampleListener() = default;
};

/// The writer's end of a connection, as the output port sees it. Links implement it.
class WriterEnd {
 public:
  virtual ~WriterEnd() = default;
  /// Passes a sample on, adding a reference of its own, and wakes the reader. False: refused and counted. The
  /// writer only; real-time safe.
  virtual bool push(SampleSlot& sample) noexcept = 0;
  /// Removes the connection from its ports. Idempotent; any thread; waits for a write or read in progress.
  virtual void disconnect() = 0;
  /// How many samples of the writer's pool it may hold at once, the reader's included.
  [[nodiscard]] virtual std::size_t capacity() const = 0;
  /// Whether `other`, of the same port, leads to the same reader with the same policy.
  [[nodiscard]] virtual bool same_as(const WriterEnd& other) const = 0;
};

/// The reader's end of a connection, as the input port sees it. Links implement it.
class ReaderEnd {
 public:
  virtual ~ReaderEnd() = default;
  /// The oldest sample that waits, or none. The reader only; real-time safe.
  virtual SampleRef pull() noexcept = 0;
  /// Whether pull() would find a sample. Any thread that holds this end.
  [[nodiscard]] virtual bool pending() const noexcept = 0;
  virtual void disconnect() = 0;
  /// The port has got a new listener to notify of samples; nullptr: none. When this returns, no writer calls
  /// the previous one any more through this connection. Any thread, one at a time.
  virtual void set_listener(SampleListener* listener) = 0;
  /// Unique within the process.
  [[nodiscard]] virtual std::uint64_t number() const noexcept = 0;
};

/// A number for ReaderEnd::number(). Any thread.
std::uint64_t next_connection_number() noexcept;

namespace detail {
/// Waits until `section` differs from `begin`. Yields and then sleeps, since the thread inside may need this
/// processor.
void wait_until_left(const std::atomic<std::uint64_t>& section, std::uint64_t begin) noexcept;
}  // namespace detail

/// The connections of a port: read by one real-time thread at a time without ever waiting, changed by any
/// other. When add() or remove() return, the reader has stopped using the previous list.
///
/// Memory order: the reader stores section_ (odd) and then loads ends_; a change exchanges ends_ and then
/// loads section_. All four are sequentially consistent, so either the reader loads the new list or the
/// change sees it inside and waits. Leaving a section releases and the change acquires, so the old list is
/// deleted after its last use. Readers that are different threads over time are ordered by their owner (a
/// task's ownership).
template <class End>
class ConnectionList {
 public:
  using Ends = std::vector<std::shared_ptr<End>>;

  ConnectionList() = default;
  ConnectionList(const ConnectionList&) = delete;
  ConnectionList& operator=(const ConnectionList&) = delete;
  ~ConnectionList() { delete ends_.load(std::memory_order_relaxed); }

  /// The reader's view, valid as long as this object lives. One at a time.
  class Section {
   public:
    explicit Section(ConnectionList& list) noexcept
        : section_(list.section_), count_(list.section_.load(std::memory_order_relaxed)) {
      section_.store(count_ + 1, std::memory_order_seq_cst);
      ends_ = list.ends_.load(std::memory_order_seq_cst);
    }
    Section(const Section&) = delete;
    Section& operator=(const Section&) = delete;
    ~Section() { section_.store(count_ + 2, std::memory_order_release); }
    [[nodiscard]] std::size_t size() const noexcept { return ends_ == nullptr ? 0 : ends_->size(); }
    End& operator[](std::size_t index) const noexcept { return *(*ends_)[index]; }

   private:
    std::atomic<std::uint64_t>& section_;
    std::uint64_t count_;
    const Ends* ends_;
  };

  void add(std::shared_ptr<End> end) {
    const std::lock_guard lock(mutex_);
    auto next = std::make_unique<Ends>();
    const Ends* now = ends_.load(std::memory_order_relaxed);
    next->reserve((now == nullptr ? 0 : now->size()) + 1);
    if (now != nullptr) *next = *now;
    next->push_back(std::move(end));
    swap(next.release());
  }

  /// False if `end` is not in the list.
  bool remove(const End* end) {
    const std::lock_guard lock(mutex_);
    const Ends* now = ends_.load(std::memory_order_relaxed);
    auto next = std::make_unique<Ends>();
    for (std::size_t i = 0; now != nullptr && i < now->size(); ++i) {
      if ((*now)[i].get() != end) next->push_back((*now)[i]);
    }
    if (now == nullptr || next->size() == now->size()) return false;
    swap(next->empty() ? nullptr : next.release());
    return true;
  }

  /// A copy of the list, for any thread but the real-time reader.
  [[nodiscard]] Ends snapshot() const {
    const std::lock_guard lock(mutex_);
    const Ends* now = ends_.load(std::memory_order_relaxed);
    return now == nullptr ? Ends{} : *now;
  }

  /// Waits until the reader has left the section that it is in, if any.
  void wait_for_reader() const noexcept {
    const std::uint64_t seen = section_.load(std::memory_order_seq_cst);
    if (seen % 2 == 1) detail::wait_until_left(section_, seen);
  }

  [[nodiscard]] bool empty() const noexcept { return ends_.load(std::memory_order_acquire) == nullptr; }

 private:
  void swap(const Ends* next) {
    const std::unique_ptr<const Ends> old(ends_.exchange(next, std::memory_order_seq_cst));
    wait_for_reader();
  }

  alignas(64) std::atomic<std::uint64_t> section_{0};  ///< odd: the reader is inside
  std::atomic<const Ends*> ends_{nullptr};             ///< nullptr: no connections
  mutable std::mutex mutex_;                           ///< serializes changes of ends_
};

}  // namespace segue::task

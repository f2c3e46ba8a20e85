// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/task/futex.hpp>
#include <segue/task/operation.hpp>

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace segue::task::detail {

/// A call that waits for the task's thread. Caller and thread share it, so either may leave first.
///
/// Memory order: whoever changes state_ from kWaiting by compare-exchange decides about the call: the thread
/// runs it or the caller abandons it, never both; an abandoned call's result is never touched.
/// - C1: finish() stores kDone with release after the result was written; wait() loads it with acquire before
///   it reads the result.
class PendingCall {
 public:
  PendingCall(std::unique_ptr<OperationCall> call, std::string operation, TimePoint deadline)
      : call_(std::move(call)), operation_(std::move(operation)), deadline_(deadline) {}

  /// The time until which the caller waits; real time.
  [[nodiscard]] TimePoint deadline() const noexcept { return deadline_; }

  /// In the task's thread. Does nothing if the caller has abandoned the call.
  void run() noexcept;
  /// Ends the call because the task goes away before its turn.
  void cancel() noexcept;
  /// In the caller's thread: waits for the result. A call that has not begun by the deadline never will.
  Result<type::Value> wait();

 private:
  enum State : std::uint32_t { kWaiting, kRunning, kDone, kAbandoned };
  void finish() noexcept;
  std::unique_ptr<OperationCall> call_;
  std::string operation_;
  const TimePoint deadline_;
  std::optional<Error> error_;
  std::atomic<std::uint32_t> state_{kWaiting};
};

/// Runs a call and turns exceptions into an error.
std::optional<Error> run_guarded(OperationCall& call, const std::string& operation);

/// Calls in the order in which they were pushed. Any thread pushes; the owner of the task takes them, without
/// waiting.
///
/// Memory order: newest_ is a stack, which is taken as a whole, so there is no ABA. waiting_ is relaxed,
/// since it only limits the length.
/// - C2: push() releases its node; take_all() takes the stack with one acquiring exchange, which synchronizes
///   with all pushes, since they are read-modify-writes.
class CallQueue {
 public:
  static constexpr int kLimit = 256;

  CallQueue() = default;
  CallQueue(const CallQueue&) = delete;
  CallQueue& operator=(const CallQueue&) = delete;
  ~CallQueue();

  /// False: kLimit calls wait already.
  bool push(std::shared_ptr<PendingCall> call);
  /// Pairs with C2: whoever finds a call sees it whole.
  [[nodiscard]] bool empty() const noexcept { return newest_.load(std::memory_order_acquire) == nullptr; }
  template <class Use>
  void take_all(Use use) {
    Node* node = in_order(newest_.exchange(nullptr, std::memory_order_acquire));  // pairs with C2
    while (node != nullptr) {
      const std::unique_ptr<Node> taken(node);
      node = node->next;
      waiting_.fetch_sub(1, std::memory_order_relaxed);
      use(*taken->call);
    }
  }

 private:
  struct Node {
    std::shared_ptr<PendingCall> call;
    Node* next = nullptr;
  };
  static Node* in_order(Node* newest) noexcept;

  std::atomic<Node*> newest_{nullptr};
  std::atomic<int> waiting_{0};
};

}  // namespace segue::task::detail

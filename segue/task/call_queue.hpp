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

/// A call on its way to the task's thread. Caller and thread share it, so either may leave first.
class PendingCall {
 public:
  explicit PendingCall(std::unique_ptr<OperationCall> call, std::string operation)
      : call_(std::move(call)), operation_(std::move(operation)) {}

  /// In the task's thread. Does nothing where the caller has given up.
  void run() noexcept;
  /// The task goes away before the call's turn.
  void cancel() noexcept;
  /// In the caller's thread.
  Result<type::Value> wait(TimePoint deadline);

 private:
  enum State : std::uint32_t { kWaiting, kRunning, kDone, kAbandoned };
  void finish() noexcept;
  std::unique_ptr<OperationCall> call_;
  std::string operation_;
  std::optional<Error> error_;
  std::atomic<std::uint32_t> state_{kWaiting};
};

/// Runs a call and catches what it throws.
std::optional<Error> run_guarded(OperationCall& call, const std::string& operation);

/// Calls in the order they came. Any thread pushes; the holder of the task takes, without waiting.
class CallQueue {
 public:
  static constexpr int kLimit = 256;

  CallQueue() = default;
  CallQueue(const CallQueue&) = delete;
  CallQueue& operator=(const CallQueue&) = delete;
  ~CallQueue();

  /// False: too many wait already.
  bool push(std::shared_ptr<PendingCall> call);
  [[nodiscard]] bool empty() const noexcept { return newest_.load(std::memory_order_acquire) == nullptr; }
  template <class Use>
  void take_all(Use use) {
    Node* node = in_order(newest_.exchange(nullptr, std::memory_order_acquire));
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

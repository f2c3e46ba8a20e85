// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/task/call_queue.hpp>

#include <exception>

namespace segue::task::detail {

std::optional<Error> run_guarded(OperationCall& call, const std::string& operation) {
  try {
    call.run();
    return std::nullopt;
  } catch (const std::exception& thrown) {
    return fail(ErrorCode::HookFailed, "operation " + quote(operation) + " threw: " + thrown.what());
  } catch (...) {
    return fail(ErrorCode::HookFailed,
                "operation " + quote(operation) + " threw something other than a std::exception");
  }
}

void PendingCall::run() noexcept {
  std::uint32_t expected = kWaiting;
  if (!state_.compare_exchange_strong(expected, kRunning, std::memory_order_acq_rel)) return;
  error_ = run_guarded(*call_, operation_);
  finish();
}

void PendingCall::cancel() noexcept {
  std::uint32_t expected = kWaiting;
  if (!state_.compare_exchange_strong(expected, kRunning, std::memory_order_acq_rel)) return;
  error_ =
      fail(ErrorCode::Cancelled, "the task was removed before operation " + quote(operation_) + " began");
  finish();
}

void PendingCall::finish() noexcept {
  state_.store(kDone, std::memory_order_release);  // C1
  futex_wake(state_, 1);
}

Result<type::Value> PendingCall::wait() {
  while (true) {
    std::uint32_t state = state_.load(std::memory_order_acquire);  // pairs with C1
    if (state == kDone) break;
    if (futex_wait(state_, state, deadline_)) continue;
    if (state == kWaiting && state_.compare_exchange_strong(state, kAbandoned, std::memory_order_acq_rel)) {
      return fail(ErrorCode::DeadlineExceeded, "operation " + quote(operation_) + " did not begin in time");
    }
    if (state_.load(std::memory_order_acquire) == kDone) break;  // pairs with C1
    return fail(ErrorCode::DeadlineExceeded, "operation " + quote(operation_) +
                                                 " has begun but not ended in time; its result will be lost");
  }
  if (error_) return *error_;
  return call_->result();
}

CallQueue::~CallQueue() {
  take_all([](PendingCall& call) { call.cancel(); });
}

bool CallQueue::push(std::shared_ptr<PendingCall> call) {
  if (waiting_.fetch_add(1, std::memory_order_relaxed) >= kLimit) {
    waiting_.fetch_sub(1, std::memory_order_relaxed);
    return false;
  }
  auto* node = new Node{std::move(call), newest_.load(std::memory_order_relaxed)};
  while (!newest_.compare_exchange_weak(node->next, node, std::memory_order_release)) {  // C2
  }
  return true;
}

CallQueue::Node* CallQueue::in_order(Node* newest) noexcept {
  Node* oldest = nullptr;
  while (newest != nullptr) {
    Node* next = newest->next;
    newest->next = oldest;
    oldest = newest;
    newest = next;
  }
  return oldest;
}

}  // namespace segue::task::detail

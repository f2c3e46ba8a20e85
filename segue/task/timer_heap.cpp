// SPDX-License-Identifier: Apache-2.0
#include <segue/task/timer_heap.hpp>

#include <utility>

namespace segue::task::detail {

/// Along the right spines of both, which are at most log2(n + 1) long each.
Timer* TimerHeap::merge(Timer* one, Timer* other) noexcept {
  if (one == nullptr) return other;
  if (other == nullptr) return one;
  if (other->due_ < one->due_) std::swap(one, other);
  one->right_ = merge(one->right_, other);
  one->right_->parent_ = one;
  if (rank(one->left_) < rank(one->right_)) std::swap(one->left_, one->right_);
  one->rank_ = rank(one->right_) + 1;
  return one;
}

void TimerHeap::set(Timer& timer, TimePoint due) noexcept {
  clear(timer);
  timer.due_ = due;
  timer.set_ = true;
  root_ = merge(root_, &timer);
  root_->parent_ = nullptr;
}

void TimerHeap::clear(Timer& timer) noexcept {
  if (!timer.set_) return;
  Timer* const rest = merge(timer.left_, timer.right_);
  Timer* parent = timer.parent_;
  if (rest != nullptr) rest->parent_ = parent;
  if (parent == nullptr) {
    root_ = rest;
  } else {
    (parent->left_ == &timer ? parent->left_ : parent->right_) = rest;
  }
  // Ranks shrink upwards, until one stays as it is.
  for (; parent != nullptr; parent = parent->parent_) {
    if (rank(parent->left_) < rank(parent->right_)) std::swap(parent->left_, parent->right_);
    const std::uint32_t now = rank(parent->right_) + 1;
    if (std::exchange(parent->rank_, now) == now) break;
  }
  timer.set_ = false;
  timer.rank_ = 1;
  timer.parent_ = timer.left_ = timer.right_ = nullptr;
}

}  // namespace segue::task::detail

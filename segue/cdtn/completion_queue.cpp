// SPDX-License-Identifier: Apache-2.0
#include "completion_queue.hpp"

#include <algorithm>

namespace segue::cdtn {

CompletionQueue::CompletionQueue(ClockKind clock) : clock_(clock) {}

TimePoint CompletionQueue::elapsed() const {
  return TimePoint{} + (RealClock::instance().now() - began_);
}

void CompletionQueue::finish_at(TimePoint when, NodeId node, std::uint32_t attempt, ReportPtr report) {
  if (when <= now_) {
    due_.push_back({now_, node, attempt, std::move(report)});
    return;
  }
  later_.push_back({when, number_++, node, attempt, std::move(report)});
  std::push_heap(later_.begin(), later_.end());
}

void CompletionQueue::finish(NodeId node, std::uint32_t attempt, ReportPtr report) {
  const std::lock_guard lock(mutex_);
  posted_.push_back({{}, node, attempt, std::move(report)});
  arrived_.notify_one();
}

CompletionQueue::Scheduled CompletionQueue::take_later() {
  std::pop_heap(later_.begin(), later_.end());
  Scheduled first = std::move(later_.back());
  later_.pop_back();
  return first;
}

void CompletionQueue::fetch_posted() {
  for (End& end : posted_) {
    end.when = now_;
    due_.push_back(std::move(end));
  }
  posted_.clear();
}

std::optional<CompletionQueue::End> CompletionQueue::take_due() {
  if (clock_ == ClockKind::Real) now_ = std::max(now_, elapsed());
  if (due_.empty()) {
    const std::lock_guard lock(mutex_);
    fetch_posted();
  }
  if (!due_.empty()) {
    End end = std::move(due_.front());
    due_.pop_front();
    return end;
  }
  if (later_.empty() || (clock_ == ClockKind::Real && later_.front().when > now_)) return std::nullopt;
  Scheduled first = take_later();
  now_ = std::max(now_, first.when);
  return End{now_, first.node, first.attempt, std::move(first.report)};
}

/// Blocks until an end may be due; false once the deadline has passed.
bool CompletionQueue::wait(TimePoint deadline) {
  std::unique_lock lock(mutex_);
  const auto arrived = [&] { return !posted_.empty(); };
  const TimePoint limit = later_.empty() ? deadline : std::min(deadline, later_.front().when);
  bool there = true;
  if (limit == TimePoint::max())
    arrived_.wait(lock, arrived);
  else
    there = arrived_.wait_until(lock, began_ + limit.time_since_epoch(), arrived);
  fetch_posted();
  return there || limit != deadline;
}

}  // namespace segue::cdtn

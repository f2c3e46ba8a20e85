// SPDX-License-Identifier: Apache-2.0
#include "completion_queue.hpp"

#include <algorithm>

namespace segue::task_network {

CompletionQueue::CompletionQueue(ClockKind clock) : clock_(clock) {}

void CompletionQueue::begin() {
  const Lock lock(mutex_);
  began_ = RealClock::instance().now();
}

Duration CompletionQueue::own_time() const {
  return clock_ == ClockKind::Real ? std::chrono::milliseconds(1) : Duration::zero();
}

TimePoint CompletionQueue::elapsed() const {
  return TimePoint{} + (RealClock::instance().now() - began_);
}

void CompletionQueue::finish_at(TimePoint when, NodeId node, std::uint32_t attempt, ReportPtr report) {
  if (!awaited_.empty()) awaited_.erase({index(node), attempt});  // whatever was announced, this is its end
  if (const TimePoint present = now(); when <= present) {
    due_.push_back({clock_ == ClockKind::Real ? when : present, node, attempt, std::move(report)});
    return;
  }
  later_.push_back({when, number_++, node, attempt, std::move(report)});
  std::push_heap(later_.begin(), later_.end());
}

void CompletionQueue::await(NodeId node, std::uint32_t attempt) {
  if (clock_ == ClockKind::Virtual) awaited_.emplace(index(node), attempt);
}

/// In real time the end is now, not when the engine gets to know of it.
void CompletionQueue::finish(NodeId node, std::uint32_t attempt, ReportPtr report) {
  const Lock lock(mutex_);
  posted_.push_back({clock_ == ClockKind::Real ? elapsed() : TimePoint{}, node, attempt, std::move(report)});
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
    if (clock_ == ClockKind::Virtual) {
      end.when = now_;
      awaited_.erase({index(end.node), end.attempt});
    }
    due_.push_back(std::move(end));
  }
  posted_.clear();
}

/// Whether time cannot jump to the next scheduled end.
bool CompletionQueue::stands_still() const {
  return clock_ == ClockKind::Real || !awaited_.empty();
}

std::optional<CompletionQueue::End> CompletionQueue::take_due() {
  if (clock_ == ClockKind::Real) now_ = std::max(now_, elapsed());
  if (!due()) {
    const Lock lock(mutex_);
    fetch_posted();
  }
  if (due()) return take_first_due();
  if (later_.empty() || (later_.front().when > now_ && stands_still())) return std::nullopt;
  Scheduled first = take_later();
  now_ = std::max(now_, first.when);
  return End{first.when, first.node, first.attempt, std::move(first.report)};
}

/// Blocks until an end may be due; false once the deadline has passed.
bool CompletionQueue::wait(TimePoint deadline) {
  Lock lock(mutex_);
  const auto arrived = [&]() SEGUE_REQUIRES(mutex_) { return !posted_.empty(); };
  const bool timed = clock_ == ClockKind::Real && !later_.empty();
  const TimePoint limit = timed ? std::min(deadline, later_.front().when) : deadline;
  bool there = true;
  if (limit == TimePoint::max())
    arrived_.wait(mutex_, arrived);
  else
    there = arrived_.wait_until(mutex_, began_ + limit.time_since_epoch(), arrived);
  fetch_posted();
  return there || limit != deadline;
}

}  // namespace segue::task_network

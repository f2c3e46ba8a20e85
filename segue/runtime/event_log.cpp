// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/event_log.hpp>

#include <algorithm>

namespace segue::runtime::detail {

namespace {
constexpr std::size_t kKeptEvents = 4096;
/// A slider sets properties so often that their events would soon push all others out.
constexpr std::size_t kKeptPropertyEvents = 1024;

bool is_trouble(EventKind kind) {
  switch (kind) {
    case EventKind::ActionFailed:
    case EventKind::TransitionFailed:
    case EventKind::TransitionUndone:
    case EventKind::RequestRefused:
    case EventKind::Difference:
    case EventKind::GivenUp:
    case EventKind::HostLost:
      return true;
    case EventKind::RequestAccepted:
    case EventKind::TransitionStarted:
    case EventKind::ActionDone:
    case EventKind::TransitionCommitted:
    case EventKind::TransitionDone:
    case EventKind::RequestSuperseded:
    case EventKind::TaskState:
    case EventKind::Process:
    case EventKind::BeliefReset:
    case EventKind::Repair:
    case EventKind::Prepared:
    case EventKind::Journal:
    case EventKind::HostFound:
    case EventKind::Files:
    case EventKind::Lease:
    case EventKind::RequestCancelled:
    case EventKind::Halt:
    case EventKind::Pool:
    case EventKind::Units:
    case EventKind::Property:
      break;
  }
  return false;
}

}  // namespace

void EventLog::add(EventKind kind, std::string subject, std::string message, bool trouble) {
  {
    const Lock lock(mutex_);
    if (kind == EventKind::Property) {
      make_room_for_property();
    }
    events_.push_back({++last_, std::chrono::system_clock::now(), kind, std::move(subject),
                       std::move(message), trouble || is_trouble(kind)});
    if (events_.size() > kKeptEvents) {
      property_events_ -= events_.front().kind == EventKind::Property ? 1 : 0;
      events_.pop_front();
    }
  }
  added_.notify_all();
}

void EventLog::make_room_for_property() {
  if (property_events_ < kKeptPropertyEvents) {
    ++property_events_;
    return;
  }
  events_.erase(std::ranges::find(events_, EventKind::Property, &Event::kind));
}

std::vector<Event> EventLog::after(std::uint64_t number, const Wait& wait) const {
  Lock lock(mutex_);
  added_.wait_until(mutex_, wait.stop, wait.deadline,
                    [&]() SEGUE_REQUIRES(mutex_) { return has_after(number) || closed_; });
  const auto first = std::ranges::upper_bound(events_, number, {}, &Event::number);
  return {first, events_.end()};
}

void EventLog::close() {
  {
    const Lock lock(mutex_);
    closed_ = true;
  }
  added_.notify_all();
}

}  // namespace segue::runtime::detail

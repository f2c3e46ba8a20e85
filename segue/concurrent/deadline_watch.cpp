// SPDX-License-Identifier: Apache-2.0
#include <segue/concurrent/deadline_watch.hpp>

#include <segue/base/log.hpp>
#include <segue/concurrent/thread.hpp>

#include <algorithm>
#include <string>
#include <system_error>
#include <utility>

namespace segue::concurrent {

namespace {

/// An alarm that is at least this far away is left as it is when its entry goes: waking once in vain costs
/// less than two system calls for each entry.
constexpr Duration kFarAway = std::chrono::milliseconds(100);

}  // namespace

void DeadlineWatch::add(EntryPtr entry, TimePoint due) {
  const Lock lock(mutex_);
  if (closed_ || !alarm_.works()) {
    return;
  }
  if (!thread_.joinable()) {
    try {
      thread_ = start_thread("segue-deadlines", [this] { watch(); });
    } catch (const std::system_error& error) {
      log(LogLevel::Error, "threads", std::string("no thread to watch deadlines: ") + error.what());
      return;
    }
  }
  items_.push_back({std::move(entry), due});
  if (due < alarm_.when()) {
    alarm_.set(due);
  }
}

void DeadlineWatch::remove(const EntryPtr& entry) {
  const Lock lock(mutex_);
  const auto found =
      std::find_if(items_.begin(), items_.end(), [&](const Item& item) { return item.entry == entry; });
  if (found == items_.end()) {
    return;
  }
  const TimePoint due = found->due;
  items_.erase(found);
  if (due == alarm_.when() && due < monotonic_now() + kFarAway) {
    set_alarm();
  }
}

void DeadlineWatch::set_alarm() {
  TimePoint first = TimePoint::max();
  for (const auto& item : items_) {
    first = std::min(first, item.due);
  }
  alarm_.set(first);
}

std::vector<DeadlineWatch::EntryPtr> DeadlineWatch::due_at(TimePoint time) {
  std::vector<EntryPtr> due;
  const Lock lock(mutex_);
  alarm_.gone_off();
  for (const auto& item : items_) {
    if (item.due <= time) {
      due.push_back(item.entry);
    }
  }
  return due;
}

void DeadlineWatch::watch() {
  while (alarm_.wait()) {
    const TimePoint time = monotonic_now();
    for (const auto& entry : due_at(time)) {
      const TimePoint next = entry->on_due(time);
      const Lock lock(mutex_);
      std::erase_if(items_,
                    [&](const Item& item) { return item.entry == entry && next == TimePoint::max(); });
      for (auto& item : items_) {
        item.due = item.entry == entry ? next : item.due;
      }
    }
    const Lock lock(mutex_);
    set_alarm();
  }
}

void DeadlineWatch::close() {
  {
    const Lock lock(mutex_);
    closed_ = true;
    if (!thread_.joinable()) {
      return;  // no thread waits for the alarm, and none is started any more
    }
    alarm_.stop();
  }
  thread_.join();
}

}  // namespace segue::concurrent

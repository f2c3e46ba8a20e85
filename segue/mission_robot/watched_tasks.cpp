// SPDX-License-Identifier: Apache-2.0
#include <segue/mission_robot/watched_tasks.hpp>

#include <algorithm>
#include <utility>

namespace segue::mission {

WatchedTasks::One& WatchedTasks::follow_one(const std::string& task, std::uint64_t after, Duration patience) {
  const auto found = std::ranges::find(tasks_, task, &One::task);
  One& one = found == tasks_.end() ? tasks_.emplace_back(task, bell_) : *found;
  one.after = std::max(one.after, after);
  one.patience = std::min(one.patience, patience);
  return one;
}

void WatchedTasks::follow(const std::string& task, std::uint64_t after, Duration patience) {
  follow_one(task, after, patience).must_be_seen = true;
}

void WatchedTasks::follow_if_seen(const std::string& task, std::uint64_t after, Duration patience) {
  follow_one(task, after, patience);
}

Result<void> WatchedTasks::poll() {
  for (One& one : tasks_) {
    if (auto taken = take(one); !taken) return taken;
  }
  return {};
}

void WatchedTasks::ask() {
  const TimePoint now = RealClock::instance().now();
  for (One& one : tasks_) {
    if (!one.question.is_asked() && now >= one.ask_at) ask(one);
  }
}

Result<void> WatchedTasks::take(One& one) {
  auto answer = one.question.take();
  if (!answer) return {};
  if (!*answer) {
    const ErrorCode code = answer->error().code;
    const bool is_gone = code == ErrorCode::NotFound || code == ErrorCode::Unavailable;
    const bool was_seen = std::exchange(one.view, std::nullopt).has_value();
    one.is_gone = one.is_gone || is_gone;
    one.ask_at = was_seen ? TimePoint() : RealClock::instance().now() + between_tries_;
    return was_seen || !one.must_be_seen ? Result<void>() : answer->error();
  }
  const bool runs = (*answer)->state == "running";
  if (one.is_gone && !runs) {
    one.ask_at = RealClock::instance().now() + kBetweenUpdates;
    return {};
  }
  note_life(one, **answer, runs);
  const bool has_changed = TaskQuestion{one.task, one.view, false}.is_news(**answer);
  one.ask_at = has_changed ? TimePoint() : RealClock::instance().now() + kBetweenUpdates;
  one.view = std::move(**answer);
  ++one.news;
  return {};
}

/// Its updates are counted from its last start.
void WatchedTasks::note_life(One& one, const TaskView& now, bool runs) {
  if (one.view && one.view->state == "running" && !runs) one.has_stopped = true;
  if (runs && (one.is_gone || one.has_stopped || now.updates < one.updates)) {
    one.is_anew = true;
    one.is_gone = one.has_stopped = false;
    if (one.after != UINT64_MAX) one.after = 0;
  }
  one.updates = now.updates;
}

bool WatchedTasks::has_begun_anew() const {
  return std::ranges::any_of(tasks_, &One::is_anew);
}

std::vector<std::string> WatchedTasks::ids() const {
  std::vector<std::string> ids;
  for (const One& one : tasks_)
    ids.push_back(one.task);
  return ids;
}

std::vector<std::string> WatchedTasks::take_begun_anew() {
  std::vector<std::string> anew;
  for (One& one : tasks_) {
    if (std::exchange(one.is_anew, false)) anew.push_back(one.task);
  }
  return anew;
}

void WatchedTasks::note_gone(std::string_view task) {
  if (const auto found = std::ranges::find(tasks_, task, &One::task); found != tasks_.end())
    found->is_gone = true;
}

bool WatchedTasks::lacks_any() const {
  return std::ranges::any_of(tasks_, &One::is_gone);
}

void WatchedTasks::ask(One& one) {
  const bool each_update = one.view && one.view->updates <= one.after;
  one.question.ask(RealClock::instance().now() + one.patience, [&](const Wait& wait, TaskAnswer answer) {
    robot_.watch({one.task, one.view, each_update}, wait, std::move(answer));
  });
}

TimePoint WatchedTasks::next_question() const {
  TimePoint next = TimePoint::max();
  for (const One& one : tasks_) {
    if (!one.question.is_asked()) next = std::min(next, one.ask_at);
  }
  return next;
}

const WatchedTasks::One* WatchedTasks::find(std::string_view task) const {
  const auto found = std::ranges::find(tasks_, task, &One::task);
  return found == tasks_.end() ? nullptr : &*found;
}

const TaskView* WatchedTasks::view(std::string_view task) const {
  const One* one = find(task);
  return one == nullptr || !one->view ? nullptr : &*one->view;
}

std::uint64_t WatchedTasks::news(std::string_view task) const {
  const One* one = find(task);
  return one == nullptr ? 0 : one->news;
}

}  // namespace segue::mission

// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/watched_tasks.hpp>

#include <algorithm>
#include <utility>

namespace segue::mission {

void WatchedTasks::follow(const std::string& task, std::uint64_t after, Duration patience) {
  auto found = std::ranges::find(tasks_, task, &One::task);
  if (found == tasks_.end()) found = tasks_.emplace(tasks_.end(), task, bell_);
  found->after = std::max(found->after, after);
  found->patience = std::min(found->patience, patience);
}

Result<void> WatchedTasks::look() {
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
    if (!std::exchange(one.view, std::nullopt)) return answer->error();
    return {};
  }
  const bool has_changed = TaskQuestion{one.task, one.view, false}.is_news(**answer);
  one.ask_at = has_changed ? TimePoint() : RealClock::instance().now() + kBetweenUpdates;
  one.view = std::move(**answer);
  ++one.news;
  return {};
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

// SPDX-License-Identifier: Apache-2.0
#include <segue/concurrent/thread.hpp>
#include <segue/mission_robot/fact_observer.hpp>

#include <segue/base/life_cycle.hpp>

#include <algorithm>
#include <iterator>
#include <utility>

namespace segue::mission {

namespace {

TimePoint time_now() {
  return RealClock::instance().now();
}

}  // namespace

FactObserver::FactObserver(std::shared_ptr<CommandedRobot> robot, std::vector<ObservedFact> facts,
                           Options options)
    : robot_(std::move(robot)),
      options_(options),
      tasks_(*robot_, bell_, options.period),
      port_tasks_(*robot_, bell_, options.period) {
  for (ObservedFact& fact : facts) {
    const auto grounded = ground(fact.fact);
    if (grounded) entries_.emplace(grounded->text, Entry{std::move(fact)});
  }
  follow_tasks();
  thread_ =
      concurrent::start_stoppable_thread("segue-facts", [this](const std::stop_token& end) { work(end); });
}

FactObserver::~FactObserver() = default;

void FactObserver::follow_tasks() {
  for (const auto& [name, entry] : entries_) {
    const RobotCondition& when = entry.declared.when;
    if (const auto* reaches = std::get_if<TaskReaches>(&when)) tasks_.follow_if_seen(reaches->task);
    if (const auto* answers = std::get_if<OperationAnswers>(&when))
      tasks_.follow_if_seen(answers->operation.task, UINT64_MAX, options_.period);
    if (const auto* shows = std::get_if<SampleShows>(&when)) port_tasks_.follow_if_seen(shows->port.task);
  }
}

void FactObserver::work(const std::stop_token& end) {
  while (!end.stop_requested()) {
    // Tasks and ports are asked anew: their last answers may be older than what somebody has been told
    // meanwhile.
    (void)tasks_.poll();
    (void)port_tasks_.poll();
    (void)ports_.poll();
    follow_ports();
    const auto again = call_watchers();
    port_tasks_.ask();
    ports_.ask();
    if (again) tasks_.ask();
    const TimePoint next = again ? std::min(*again, tasks_.next_question()) : TimePoint::max();
    bell_->wait({std::min({next, port_tasks_.next_question(), ports_.next_question()}), end});
  }
}

/// All the time, since what a sample has shown counts until the next one.
void FactObserver::follow_ports() {
  for (auto& [name, entry] : entries_) {
    const Lock lock(polling_);
    const auto* shows = std::get_if<SampleShows>(&entry.declared.when);
    if (shows == nullptr) continue;
    poll(entry);
    if (entry.feed && entry.followed == entry.opened) continue;
    follow_port(entry, shows->port);
    poll(entry);  // samples that came before it was followed
  }
}

/// A port has two readers, since one that is waited for is not read.
void FactObserver::follow_port(Entry& entry, const Member& port) {
  ports_.forget(port);
  entry.followed = {};
  if (!entry.feed) return;
  auto samples = robot_->open(port, time_now() + options_.answer_deadline);
  if (!samples) return;
  ports_.follow(port, std::move(*samples));
  entry.followed = entry.opened;
}

std::optional<TimePoint> FactObserver::call_watchers() {
  Lock lock(mutex_);
  auto watches = std::exchange(watches_, {});
  lock.unlock();
  std::optional<TimePoint> again;
  std::erase_if(watches, [&again](const Poll& poll) {
    const auto next = poll();
    if (next) again = std::min(*next, again.value_or(TimePoint::max()));
    return !next;
  });
  lock.lock();
  watches_.insert(watches_.end(), std::make_move_iterator(watches.begin()),
                  std::make_move_iterator(watches.end()));
  return again;
}

std::optional<bool> FactObserver::poll(Entry& entry) {
  const auto seen = std::visit([&](const auto& when) { return poll(entry, when); }, entry.declared.when);
  if (seen) entry.value = *seen;
  entry.seen = entry.seen || seen;
  return seen;
}

/// The states that a component declares are those of its task while that runs, or has failed.
std::optional<bool> FactObserver::poll(Entry& /*entry*/, const TaskReaches& when) {
  const auto task = robot_->task(when.task, time_now() + options_.answer_deadline);
  if (!task) return std::nullopt;
  if (is_in(*task, when)) return true;
  const bool of_life_cycle = std::ranges::find(kTaskStateNames, when.state) != kTaskStateNames.end();
  if (of_life_cycle || task->state == "running") return false;
  return std::nullopt;
}

/// A feed does not say that its task is gone, or is there anew.
std::optional<bool> FactObserver::poll(Entry& entry, const SampleShows& when) {
  const auto task = robot_->task(when.port.task, time_now() + options_.answer_deadline);
  if (!task || task->updates < entry.updates) entry.feed.reset();
  entry.updates = task ? task->updates : 0;
  if (!task) return std::nullopt;
  if (!entry.feed) {
    auto opened = PortFeed::open(*robot_, when.port, time_now() + options_.answer_deadline);
    if (!opened) return std::nullopt;
    entry.feed = std::move(*opened);
    entry.opened = time_now();
  }
  if (!entry.feed->poll(time_now() + options_.answer_deadline)) {
    entry.feed.reset();
    return std::nullopt;
  }
  if (!entry.feed->last) return std::nullopt;
  return holds(when.what, *entry.feed->last);
}

std::optional<bool> FactObserver::poll(Entry& /*entry*/, const OperationAnswers& when) {
  const auto answer = holds(*robot_, when, time_now() + options_.answer_deadline);
  return answer ? std::optional(*answer) : std::nullopt;
}

/// The value of the fact as a poll shows it, or else as it was known last.
bool FactObserver::value_now(Entry& entry) {
  while (!poll(entry)) {
    const bool may_still_come =
        entry.feed && !entry.feed->last && time_now() < entry.opened + entry.declared.settle;
    if (!may_still_come) break;
    wait_for_next_poll(std::chrono::milliseconds(1), {});
  }
  return entry.value;
}

void FactObserver::begin(const World::Facts& facts) {
  const Lock lock(polling_);
  for (auto& [name, entry] : entries_) {
    if (!entry.seen) entry.value = facts.contains(name);
  }
}

std::optional<GroundFact> FactObserver::first_false(std::span<const GroundFact> facts) {
  const Lock lock(polling_);
  for (const GroundFact& fact : facts) {
    const auto found = entries_.find(fact.text);
    if (found != entries_.end() && value_now(found->second) != fact.holds) return fact;
  }
  return std::nullopt;
}

std::optional<bool> FactObserver::observed(std::string_view fact) {
  const Lock lock(polling_);
  const auto found = entries_.find(fact);
  return found == entries_.end() ? std::nullopt : poll(found->second);
}

void FactObserver::assume(std::span<const GroundFact> effects) {
  const Lock lock(polling_);
  for (const GroundFact& effect : effects) {
    if (const auto found = entries_.find(effect.text); found != entries_.end())
      found->second.value = effect.holds;
  }
}

Duration FactObserver::settle(std::string_view fact) const {
  const auto found = entries_.find(fact);
  return found == entries_.end() ? Duration::zero() : found->second.declared.settle;
}

void FactObserver::watch(Poll poll) {
  {
    const Lock lock(mutex_);
    watches_.push_back(std::move(poll));
  }
  bell_->ring();
}

}  // namespace segue::mission

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

/// The port whose samples show it; null: something else does.
const Member* port_of(const ObservedUnits& observed) {
  if (const auto* counts = std::get_if<SampleCounts>(&observed)) return &counts->port;
  const auto* shows = std::get_if<SampleShows>(&std::get<RobotCondition>(observed));
  return shows == nullptr ? nullptr : &shows->port;
}

}  // namespace

FactObserver::FactObserver(std::shared_ptr<CommandedRobot> robot, const Mission& mission, Options options)
    : robot_(std::move(robot)),
      options_(std::move(options)),
      tasks_(*robot_, bell_, options_.period),
      port_tasks_(*robot_, bell_, options_.period),
      changes_(*robot_, bell_) {
  for (const ObservedFact& fact : mission.observed) {
    if (const auto grounded = ground(fact.fact))
      facts_.emplace(grounded->text, Entry{.when = fact.when, .settle = fact.settle});
  }
  for (const Resource& resource : mission.resources) {
    if (resource.observe) resources_.emplace(resource.name, Entry{.when = *resource.observe});
  }
  for (auto* entries : {&facts_, &resources_}) {
    for (auto& [name, entry] : *entries)
      entries_.push_back(&entry);
  }
  follow_tasks();
  thread_ =
      concurrent::start_stoppable_thread("segue-facts", [this](const std::stop_token& end) { work(end); });
}

FactObserver::~FactObserver() = default;

void FactObserver::follow_tasks() {
  for (const Entry* entry : entries_) {
    if (const Member* port = port_of(entry->when)) {
      port_tasks_.follow_if_seen(port->task);
      continue;
    }
    const auto& when = std::get<RobotCondition>(entry->when);
    if (const auto* reaches = std::get_if<TaskReaches>(&when)) tasks_.follow_if_seen(reaches->task);
    if (const auto* answers = std::get_if<OperationAnswers>(&when))
      tasks_.follow_if_seen(answers->operation.task, UINT64_MAX, options_.period);
  }
}

void FactObserver::work(const std::stop_token& end) {
  end_ = end;
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
    if (unit_watches_ > 0) changes_.ask();
    const TimePoint next = again ? std::min(*again, tasks_.next_question()) : TimePoint::max();
    const TimePoint news = unit_watches_ > 0 ? changes_.next_question() : TimePoint::max();
    bell_->wait({std::min({next, news, port_tasks_.next_question(), ports_.next_question()}), end});
  }
}

/// All the time, since what a sample has shown counts until the next one.
void FactObserver::follow_ports() {
  for (Entry* entry : entries_) {
    const Lock lock(polling_);
    const Member* port = port_of(entry->when);
    if (port == nullptr) continue;
    poll(*entry);
    if (entry->feed && entry->followed == entry->opened) continue;
    follow_port(*entry, *port);
    poll(*entry);  // samples that came before it was followed
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

std::optional<std::uint32_t> FactObserver::poll(Entry& entry) {
  const auto seen = std::visit([&](const auto& when) { return poll(entry, when); }, entry.when);
  if (seen) entry.value = *seen;
  entry.seen = entry.seen || seen;
  return seen;
}

std::optional<std::uint32_t> FactObserver::poll(Entry& entry, const RobotCondition& when) {
  const auto holds = std::visit([&](const auto& one) { return look(entry, one); }, when);
  if (!holds) return std::nullopt;
  return *holds ? kAllUnits : 0;
}

std::optional<std::uint32_t> FactObserver::poll(Entry& entry, const SampleCounts& when) {
  const type::Value* sample = last_sample(entry, when.port);
  return sample == nullptr ? std::nullopt : std::optional(units_in(when, *sample));
}

/// The states that a component declares are those of its task while that runs, or has failed.
std::optional<bool> FactObserver::look(Entry& /*entry*/, const TaskReaches& when) {
  const auto task = robot_->task(when.task, time_now() + options_.answer_deadline);
  if (!task) return std::nullopt;
  if (is_in(*task, when)) return true;
  const bool of_life_cycle = std::ranges::find(kTaskStateNames, when.state) != kTaskStateNames.end();
  if (of_life_cycle || task->state == "running") return false;
  return std::nullopt;
}

std::optional<bool> FactObserver::look(Entry& entry, const SampleShows& when) {
  const type::Value* sample = last_sample(entry, when.port);
  return sample == nullptr ? std::nullopt : std::optional(holds(when.what, *sample));
}

std::optional<bool> FactObserver::look(Entry& /*entry*/, const OperationAnswers& when) {
  const auto answer = holds(*robot_, when, time_now() + options_.answer_deadline);
  return answer ? std::optional(*answer) : std::nullopt;
}

/// The latest sample of the entry's port; null where there is none. A feed does not say that its task is
/// gone, or is there anew.
const type::Value* FactObserver::last_sample(Entry& entry, const Member& port) {
  const auto task = robot_->task(port.task, time_now() + options_.answer_deadline);
  if (!task || task->updates < entry.updates) entry.feed.reset();
  entry.updates = task ? task->updates : 0;
  if (!task) return nullptr;
  if (!entry.feed) {
    auto opened = PortFeed::open(*robot_, port, time_now() + options_.answer_deadline);
    if (!opened) return nullptr;
    entry.feed = std::move(*opened);
    entry.opened = time_now();
  }
  if (!entry.feed->poll(time_now() + options_.answer_deadline)) {
    entry.feed.reset();
    return nullptr;
  }
  return entry.feed->last ? &*entry.feed->last : nullptr;
}

/// Whether the fact holds as a poll shows it, or else as it was known last.
bool FactObserver::value_now(Entry& entry) {
  while (!poll(entry)) {
    const bool may_still_come = entry.feed && !entry.feed->last && time_now() < entry.opened + entry.settle;
    if (!may_still_come) break;
    wait_for_next_poll(std::chrono::milliseconds(1), {});
  }
  return entry.value != 0;
}

void FactObserver::begin(const World::Facts& facts) {
  const Lock lock(polling_);
  for (auto& [name, entry] : facts_) {
    if (!entry.seen) entry.value = facts.contains(name) ? kAllUnits : 0;
  }
}

std::optional<GroundFact> FactObserver::first_false(std::span<const GroundFact> facts) {
  const Lock lock(polling_);
  for (const GroundFact& fact : facts) {
    const auto found = facts_.find(fact.text);
    if (found != facts_.end() && value_now(found->second) != fact.holds) return fact;
  }
  return std::nullopt;
}

std::optional<bool> FactObserver::observed(std::string_view fact) {
  const Lock lock(polling_);
  const auto found = facts_.find(fact);
  const auto value = found == facts_.end() ? std::nullopt : poll(found->second);
  return value ? std::optional(*value != 0) : std::nullopt;
}

void FactObserver::assume(std::span<const GroundFact> effects) {
  const Lock lock(polling_);
  for (const GroundFact& effect : effects) {
    if (const auto found = facts_.find(effect.text); found != facts_.end())
      found->second.value = effect.holds ? kAllUnits : 0;
  }
}

Duration FactObserver::settle(std::string_view fact) const {
  const auto found = facts_.find(fact);
  return found == facts_.end() ? Duration::zero() : found->second.settle;
}

void FactObserver::watch(Poll poll) {
  {
    const Lock lock(mutex_);
    watches_.push_back(std::move(poll));
  }
  bell_->ring();
}

std::vector<std::string> FactObserver::resources() const {
  std::vector<std::string> names;
  for (const auto& [name, entry] : resources_)
    names.push_back(name);
  return names;
}

std::shared_ptr<void> FactObserver::watch_units(std::function<void(const ShownUnits&)> changed) {
  auto watched = std::make_shared<ShownUnits>();
  if (resources_.empty()) return watched;
  watch([this, changed = std::move(changed), weak = std::weak_ptr(watched),
         has_begun = false]() mutable -> std::optional<TimePoint> {
    const auto last = weak.lock();
    if (!last && has_begun) --unit_watches_;
    if (!last) return std::nullopt;
    if (!has_begun) ++unit_watches_;
    ShownUnits now = shown_units();
    if (std::exchange(has_begun, true) && now == *last) return TimePoint::max();
    *last = now;
    changed(now);
    return TimePoint::max();
  });
  return watched;
}

ShownUnits FactObserver::shown_units() {
  ShownUnits shown;
  {
    const Lock lock(polling_);
    for (auto& [name, entry] : resources_)
      shown.units.emplace(name, poll(entry).value_or(0));
  }
  shown.lost = why_lost();
  return shown;
}

/// Nobody waits for a robot that the mission has lost. It is asked only when something has changed there.
std::string FactObserver::why_lost() {
  if (!lost_.empty() || !changes_.take()) return lost_;
  const auto why = robot_->lost_command(end_);
  if (why) {
    lost_ = why->value_or("");
  } else if (options_.unreachable && !end_.stop_requested()) {
    options_.unreachable(why.error());  // which ends the run
  } else {
    lost_ = why.error().message;
  }
  return lost_;
}

}  // namespace segue::mission

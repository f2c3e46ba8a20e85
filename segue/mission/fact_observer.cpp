// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/fact_observer.hpp>

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
    : robot_(std::move(robot)), options_(options) {
  for (ObservedFact& fact : facts) {
    const auto grounded = ground(fact.fact);
    if (grounded) entries_.emplace(grounded->text, Entry{std::move(fact)});
  }
  thread_ = std::jthread([this](const std::stop_token& end) { work(end); });
}

FactObserver::~FactObserver() = default;

/// Ports are followed all the time, since what a sample has shown counts until the next one.
void FactObserver::work(const std::stop_token& end) {
  while (!end.stop_requested()) {
    for (auto& [name, entry] : entries_) {
      const std::lock_guard lock(looking_);
      if (std::holds_alternative<SampleShows>(entry.declared.when)) look(entry);
    }
    std::unique_lock lock(mutex_);
    auto watches = std::exchange(watches_, {});
    lock.unlock();
    std::erase_if(watches, [](const auto& look) { return !look(); });
    lock.lock();
    watches_.insert(watches_.end(), std::make_move_iterator(watches.begin()),
                    std::make_move_iterator(watches.end()));
    lock.unlock();
    wait_for_next_look(options_.period, end);
  }
}

std::optional<bool> FactObserver::look(Entry& entry) {
  const auto seen = std::visit([&](const auto& when) { return look(entry, when); }, entry.declared.when);
  if (seen) entry.value = *seen;
  entry.seen = entry.seen || seen;
  return seen;
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

/// A feed does not say that its task is gone, or is there anew.
std::optional<bool> FactObserver::look(Entry& entry, const SampleShows& when) {
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
  if (!entry.feed->look(time_now() + options_.answer_deadline)) {
    entry.feed.reset();
    return std::nullopt;
  }
  if (!entry.feed->last) return std::nullopt;
  return holds(when.what, *entry.feed->last);
}

std::optional<bool> FactObserver::look(Entry& /*entry*/, const OperationAnswers& when) {
  const auto answer = holds(*robot_, when, time_now() + options_.answer_deadline);
  return answer ? std::optional(*answer) : std::nullopt;
}

/// As a look shows it, or else as it was known last.
bool FactObserver::value_now(Entry& entry) {
  while (!look(entry)) {
    const bool may_still_come =
        entry.feed && !entry.feed->last && time_now() < entry.opened + entry.declared.settle;
    if (!may_still_come) break;
    wait_for_next_look(std::chrono::milliseconds(1), {});
  }
  return entry.value;
}

void FactObserver::begin(const World::Facts& facts) {
  const std::lock_guard lock(looking_);
  for (auto& [name, entry] : entries_) {
    if (!entry.seen) entry.value = facts.contains(name);
  }
}

std::optional<GroundFact> FactObserver::first_false(std::span<const GroundFact> facts) {
  const std::lock_guard lock(looking_);
  for (const GroundFact& fact : facts) {
    const auto found = entries_.find(fact.text);
    if (found != entries_.end() && value_now(found->second) != fact.holds) return fact;
  }
  return std::nullopt;
}

std::optional<bool> FactObserver::observed(std::string_view fact) {
  const std::lock_guard lock(looking_);
  const auto found = entries_.find(fact);
  return found == entries_.end() ? std::nullopt : look(found->second);
}

void FactObserver::assume(std::span<const GroundFact> effects) {
  const std::lock_guard lock(looking_);
  for (const GroundFact& effect : effects) {
    if (const auto found = entries_.find(effect.text); found != entries_.end())
      found->second.value = effect.holds;
  }
}

Duration FactObserver::settle(std::string_view fact) const {
  const auto found = entries_.find(fact);
  return found == entries_.end() ? Duration::zero() : found->second.declared.settle;
}

void FactObserver::watch(std::function<bool()> look) {
  const std::lock_guard lock(mutex_);
  watches_.push_back(std::move(look));
}

}  // namespace segue::mission

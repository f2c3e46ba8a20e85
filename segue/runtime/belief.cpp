// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/belief.hpp>

#include <segue/base/clock.hpp>
#include <segue/model/network_sets.hpp>

#include <algorithm>

namespace segue::runtime::detail {

namespace {

/// Whether a computer was lost or found after that moment.
bool any_came_or_went_since(TimePoint begin, const task_host::TaskHost& host) {
  const auto computers = host.computers();
  const Duration elapsed = RealClock::instance().now() - begin;
  return std::any_of(computers.begin(), computers.end(), [&](const task_host::ComputerReport& computer) {
    return computer.name != model::kLocalHost && computer.since < elapsed;
  });
}

}  // namespace

model::Network BeliefState::all() const {
  return extra.empty() ? controller : unite(controller, extra);
}

model::Network BeliefState::desired() const {
  return wanted ? unite(*wanted, extra) : all();
}

BeliefState split_observation(model::Network seen, const model::Network& controller,
                              std::optional<model::Network> wanted) {
  BeliefState belief;
  // A task that is wanted belongs to the controller also where it was not seen before, as on a host that was
  // lost.
  belief.extra = subtract(seen, wanted ? unite(controller, *wanted) : controller);
  belief.controller = belief.extra.empty() ? std::move(seen) : subtract(seen, belief.extra);
  belief.controller.name = controller.name;
  belief.wanted = std::move(wanted);
  return belief;
}

Observation Belief::observe() const {
  constexpr int kAttempts = 4;  // a computer that comes and goes all the time delays nobody for long
  Observation seen;
  for (int attempt = 1;; ++attempt) {
    const TimePoint begin = RealClock::instance().now();
    {
      const Lock lock(mutex_);
      seen.task_events = task_events_;
      seen.adoptions = adoptions_;
    }
    seen.network = host_.observe();
    if (attempt == kAttempts || !any_came_or_went_since(begin, host_)) {
      return seen;
    }
  }
}

BeliefState Belief::held() const {
  const Lock lock(mutex_);
  return held_;
}

model::Network Belief::controller() const {
  const Lock lock(mutex_);
  return held_.controller;
}

std::string Belief::version() const {
  const Lock lock(mutex_);
  return held_.wanted ? held_.wanted->version : std::string();
}

bool Belief::is_assumed() const {
  const Lock lock(mutex_);
  return assumed_;
}

void Belief::adopt(BeliefState seen, std::uint64_t task_events) {
  const Lock lock(mutex_);
  replace(std::move(seen), task_events);
}

bool Belief::refresh(BeliefState seen, const Observation& observed) {
  const Lock lock(mutex_);
  if (observed.adoptions != adoptions_) {
    return false;
  }
  replace(std::move(seen), observed.task_events);
  return true;
}

void Belief::replace(BeliefState seen, std::uint64_t task_events) {
  hold(std::move(seen));
  assumed_ = false;
  for (const auto& [id, last] : reported_) {
    if (last.first > task_events) {
      set_state(id, last.second);
    }
  }
}

void Belief::hold(BeliefState state) {
  ++adoptions_;
  held_ = std::move(state);
  states_.clear();
  for (model::Network* network : {&held_.controller, &held_.extra}) {
    for (model::Task& task : network->tasks) {
      states_.emplace(task.id, &task.state);
    }
  }
}

void Belief::set_state(const model::TaskId& id, TaskState state) {
  for (auto [one, end] = states_.equal_range(id); one != end; ++one) {
    *one->second = state;
  }
}

void Belief::adopt_assumed(model::Network network) {
  const Lock lock(mutex_);
  hold({std::move(network), {}, {}});
  assumed_ = true;
}

void Belief::on_event(const task_host::TaskEvent& event) {
  const Lock lock(mutex_);
  reported_.insert_or_assign(event.task, std::pair(++task_events_, event.state));
  set_state(event.task, event.state);
}

Observation Belief::starting_point() const {
  Observation start;
  {
    const Lock lock(mutex_);
    start = {held_.all(), task_events_, adoptions_};
    if (assumed_) {
      return start;
    }
  }
  Observation observed = observe();
  if (equivalent(start.network, observed.network)) {
    return start;
  }
  observed.network.name = start.network.name;
  return observed;
}

}  // namespace segue::runtime::detail

// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/belief.hpp>

#include <segue/runtime/beside.hpp>

namespace segue::runtime::detail {

namespace {

void set_state(Holding& held, const model::TaskId& id, TaskState state) {
  for (model::Network* network : {&held.controller, &held.beside}) {
    if (model::Task* task = network->find_task(id)) {
      task->state = state;
    }
  }
}

}  // namespace

model::Network Holding::all() const {
  return beside.empty() ? controller : together(controller, beside);
}

model::Network Holding::shall() const {
  return wanted ? together(*wanted, beside) : all();
}

Holding split(model::Network seen, const model::Network& controller, std::optional<model::Network> wanted) {
  Holding holding;
  holding.beside = without(seen, controller);
  holding.controller = holding.beside.empty() ? std::move(seen) : without(seen, holding.beside);
  holding.controller.name = controller.name;
  holding.wanted = std::move(wanted);
  return holding;
}

Observation Belief::look() const {
  Observation seen;
  {
    const std::lock_guard lock(mutex_);
    seen.task_events = task_events_;
    seen.adoptions = adoptions_;
  }
  seen.network = host_.observe();
  return seen;
}

Holding Belief::held() const {
  const std::lock_guard lock(mutex_);
  return held_;
}

model::Network Belief::controller() const {
  const std::lock_guard lock(mutex_);
  return held_.controller;
}

bool Belief::is_given() const {
  const std::lock_guard lock(mutex_);
  return given_;
}

void Belief::adopt(Holding seen, std::uint64_t task_events) {
  const std::lock_guard lock(mutex_);
  replace(std::move(seen), task_events);
}

bool Belief::renew(Holding seen, const Observation& look) {
  const std::lock_guard lock(mutex_);
  if (look.adoptions != adoptions_) {
    return false;
  }
  replace(std::move(seen), look.task_events);
  return true;
}

void Belief::replace(Holding seen, std::uint64_t task_events) {
  ++adoptions_;
  held_ = std::move(seen);
  given_ = false;
  for (const auto& [id, last] : told_) {
    if (last.first > task_events) {
      set_state(held_, id, last.second);
    }
  }
}

void Belief::adopt_given(model::Network network) {
  const std::lock_guard lock(mutex_);
  ++adoptions_;
  held_ = {std::move(network), {}, {}};
  given_ = true;
}

void Belief::on_event(const host::TaskEvent& event) {
  const std::lock_guard lock(mutex_);
  told_.insert_or_assign(event.task, std::pair(++task_events_, event.state));
  set_state(held_, event.task, event.state);
}

Observation Belief::starting_point() const {
  Observation start;
  {
    const std::lock_guard lock(mutex_);
    start = {held_.all(), task_events_, adoptions_};
    if (given_) {
      return start;
    }
  }
  Observation observed = look();
  if (equivalent(start.network, observed.network)) {
    return start;
  }
  observed.network.name = start.network.name;
  return observed;
}

}  // namespace segue::runtime::detail

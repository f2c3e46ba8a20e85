// SPDX-License-Identifier: Apache-2.0
#include <segue/model/transition.hpp>
#include <segue/task_host/early_end.hpp>
#include <segue/task_host/ordered_actions.hpp>
#include <segue/task_host/task_host.hpp>

#include <utility>

namespace segue::task_host {

Result<void> TaskHost::can_make(const model::ComponentName& /*component*/) const {
  return {};
}

bool TaskHost::stands_in(const model::ComponentName& /*component*/) const {
  return false;
}

TaskHost::View TaskHost::snapshot() const {
  return {observe(), tasks(), connections()};
}

Diagnostics TaskHost::check(const model::Network& /*network*/) const {
  return {};
}

Result<void> TaskHost::perform(const model::Action& action, Deadline deadline) {
  return std::move(perform_all(std::span(&action, 1), deadline).front());
}

void TaskHost::perform_in_order(std::vector<model::Action> actions, Duration action_deadline,
                                const EarlyEnd& early_end, Completion completed) {
  OrderedActions::Performer performer;
  performer.begin = [this](std::vector<model::Action> batch, TimePoint deadline, Completion ended) {
    begin_all(std::move(batch), deadline, std::move(ended));
  };
  performer.observe = [this] { return observe(); };
  std::make_shared<OrderedActions>(std::move(actions), action_deadline, std::move(performer),
                                   std::move(completed))
      ->run(early_end);
}

std::vector<ComputerReport> TaskHost::computers() const {
  return {};
}

model::Network TaskHost::expanded(model::Network network) const {
  return network;
}

model::Network TaskHost::condensed(model::Network network) const {
  return network;
}

void TaskHost::expect(const model::Network& /*target*/) {}

void TaskHost::begin_transition(const model::Network& /*before*/, const model::Network& target) {
  expect(target);
}

void TaskHost::get_ready(const model::Network& /*target*/) {}

Result<void> TaskHost::arm_commit(const model::Transition& /*transition*/, TimePoint /*deadline*/) {
  return {};
}

Result<void> TaskHost::commit() {
  return {};
}

void TaskHost::conclude(const model::Transition& /*transition*/) {}

void TaskHost::withdraw() {}

}  // namespace segue::task_host

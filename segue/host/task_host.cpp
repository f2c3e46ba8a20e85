// SPDX-License-Identifier: Apache-2.0
#include <segue/host/task_host.hpp>

namespace segue::host {

Result<void> TaskHost::can_make(const model::ComponentName& /*component*/) const {
  return {};
}

Diagnostics TaskHost::check(const model::Network& /*network*/) const {
  return {};
}

std::vector<Result<void>> TaskHost::perform_all(std::span<const model::Action> actions, TimePoint deadline) {
  std::vector<Result<void>> outcomes;
  outcomes.reserve(actions.size());
  for (const auto& action : actions) {
    outcomes.push_back(perform(action, deadline));
  }
  return outcomes;
}

void TaskHost::expect(const model::Network& /*target*/) {}

void TaskHost::conclude(const model::Transition& /*transition*/) {}

}  // namespace segue::host

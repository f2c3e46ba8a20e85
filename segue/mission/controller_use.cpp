// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/controller_use.hpp>

#include <segue/base/life_cycle.hpp>

#include <algorithm>

namespace segue::mission {

bool can_be_watched(const ControllerUse& use) {
  const auto sees = [](const EndCondition& one) { return std::holds_alternative<RobotCondition>(one.when); };
  return use.until.empty() || std::ranges::any_of(use.until, sees);
}

bool awaits_failure(const ControllerUse& use, const std::string& task) {
  return std::ranges::any_of(use.until, [&](const EndCondition& condition) {
    const auto* reaches = condition_of<TaskReaches>(condition);
    if (reaches == nullptr || reaches->task != task) return false;
    const auto state = task_state_from(reaches->state);
    return state && is_error(*state);
  });
}

}  // namespace segue::mission

// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/controllers.hpp>

#include <algorithm>
#include <string>

namespace segue::mission {

namespace {

bool uses_controller(const Action& action) {
  return std::holds_alternative<ControllerUse>(action.run);
}

}  // namespace

bool uses_controllers(const Mission& mission) {
  return std::ranges::any_of(mission.actions, uses_controller);
}

void claim_controllers(Mission& mission) {
  if (!uses_controllers(mission)) return;
  for (Action& action : mission.actions) {
    if (!uses_controller(action)) continue;
    ResourceUse use;
    use.resource = kControllerResource;
    use.where = action.where;
    action.resources.push_back(std::move(use));
  }
  Resource resource;
  resource.name = kControllerResource;
  mission.resources.push_back(std::move(resource));
}

}  // namespace segue::mission

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/mission/mission.hpp>
#include <segue/model/component.hpp>
#include <segue/model/network.hpp>

#include <string_view>
#include <vector>

/// Actions that controllers of the robot carry out.
namespace segue::mission {

/// The robot runs one controller at a time: an action that uses one holds this resource, of which there is
/// one unit, from its begin to its end.
inline constexpr std::string_view kControllerResource = "the robot's controller";

[[nodiscard]] bool uses_controllers(const Mission& mission);

/// Whether a robot with these controllers has what actions ask of them: tasks, ports, properties, operations
/// with their arguments, and states, in every controller that the name of an action can mean. Tasks of
/// components that the catalog lacks may have anything.
void check_controllers(const Mission& mission, const std::vector<model::Network>& controllers,
                       const model::ComponentCatalog& catalog, Diagnostics& diagnostics);

/// Adds that resource to the actions that need it, and to the mission.
void claim_controllers(Mission& mission);

}  // namespace segue::mission

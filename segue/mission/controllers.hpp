// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/mission/commanded_robot.hpp>
#include <segue/mission/mission.hpp>
#include <segue/model/component_model.hpp>
#include <segue/model/network.hpp>
#include <segue/model/robot.hpp>

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Actions that controllers of the robot carry out.
namespace segue::mission {

/// The resource of actions that use a controller, where it is not known which controllers can run at once:
/// there is one unit of it, which each such action holds from its begin to its end.
inline constexpr std::string_view kControllerResource = "the robot's controller";

[[nodiscard]] bool uses_controllers(const Mission& mission);
/// Whether it observes facts or units.
[[nodiscard]] bool observes(const Mission& mission);
/// Whether it uses controllers or pools, has scripts that use a robot, observes facts or units, or uses units
/// of the robot.
[[nodiscard]] bool needs_robot(const Mission& mission);

/// ControllerUse::controller with the value of each input in place of "{input}"; nothing where one has none.
[[nodiscard]] std::optional<std::string> controller_name(
    std::string name, const std::function<std::optional<std::string>(const std::string& input)>& value_of);

/// Whether ControllerUse::controller, with inputs in it, can be that controller.
[[nodiscard]] bool can_mean(std::string pattern, std::string_view controller);

/// Whether a robot with these controllers has what actions ask of them: tasks, ports, properties, operations
/// with their arguments, and states, in every controller that the name of an action can mean; and what its
/// observed facts are bound to, in every controller that has that task. Tasks of components that the catalog
/// lacks may have anything.
void check_controllers(const Mission& mission, const std::vector<model::Network>& controllers,
                       const model::ComponentCatalog& catalog, Diagnostics& diagnostics);

/// Whether the robot keeps the counts of all units of which the mission says so (Resource::of_robot).
void check_robot_units(const Mission& mission, const std::vector<model::UnitStock>& units,
                       Diagnostics& diagnostics);

/// Adds resources of one unit, which actions hold from their begin to their end, so that no two run whose
/// controllers cannot run at once: "controller drive" of actions that use the same one, and what controllers
/// need each in its own way, such as "task arm". Without `conflicts`: kControllerResource. An action whose
/// controller's name depends on an input holds what any of them needs.
void claim_controllers(Mission& mission, const ControllerConflicts* conflicts = nullptr);

}  // namespace segue::mission

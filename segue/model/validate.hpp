// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/model/component_model.hpp>
#include <segue/model/network.hpp>
#include <segue/model/robot.hpp>
#include <segue/model/transition.hpp>

#include <functional>
#include <vector>

namespace segue::model {

enum class Depth {
  Structure,  ///< names and references only: enough to compute with
  Full        ///< also components, ports, types, properties: enough to run
};

/// All problems of a network, each with its location: two tasks of an id; a task in two deployments; a
/// process twice on a host; connections to unknown tasks; two connections of the same ports; error states as
/// target; a connection at a dynamic port of a task that is not configured. With Depth::Full also: unknown
/// components, abstract components, unknown ports, output to output, types that do not match, properties that
/// do not exist or have the wrong type, devices claimed twice. Linear in the size of the network.
Diagnostics validate(const Network& network, const ComponentCatalog& catalog, Depth depth);

/// Whether tasks of a component are stand-ins.
using StandsIn = std::function<bool(const ComponentName&)>;

/// All problems of Depth::Full of a network whose tasks may be stand-ins. Their components may be unknown or
/// abstract, and they take properties and, if their model is incomplete, ports that it lacks. All else that
/// the model of a stand-in says holds for it, too: a value that has the wrong type is an error.
Diagnostics validate(const Network& network, const ComponentCatalog& catalog, const StandsIn& stands_in);

/// The wrong references of a network whose file has errors (read_network_parts()): names that do not exist,
/// that stand for a part of another type or direction, or that are used twice, as far as that does not follow
/// from the parts that could not be read.
Diagnostics validate_references(const Network& parts, const ComponentCatalog& catalog, Depth depth);

/// All problems of a robot and its networks together: unknown hosts, controllers of one name, tasks and
/// processes that belong to a pool ...
Diagnostics validate(const Robot& robot, const std::vector<Network>& networks);

/// An error for each transition of a robot that has the name of another one.
void check_names(const std::vector<Transition>& transitions, Diagnostics& diagnostics);

/// The problems of a robot's halt, if it has one: conditions that name states, ports and operations that do
/// not exist.
void check_halt_members(const Robot& robot, const std::vector<Network>& networks,
                        const ComponentCatalog& catalog, Diagnostics& diagnostics);

}  // namespace segue::model

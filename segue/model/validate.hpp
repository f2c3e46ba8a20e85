// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/model/component.hpp>
#include <segue/model/network.hpp>
#include <segue/model/robot.hpp>

namespace segue::model {

enum class Depth {
  Structure,  ///< names and references only: enough to compute with
  Full        ///< also components, ports, types, properties: enough to run
};

/// Every problem of a network at once, each with its place: two tasks of an id; a task in two deployments; a
/// process twice on a host; connections to unknown tasks; two wires with the same ends; error states as
/// target; a wire on a dynamic port of a task that is not to be configured. With Depth::Full also: unknown
/// components, abstract components, unknown ports, output to output, types that do not match, properties that
/// do not exist or have the wrong type, devices claimed twice. Linear in the size of the network.
Diagnostics validate(const Network& network, const ComponentCatalog& catalog, Depth depth);

/// Hosts that do not exist, controllers twice ... for a robot and its networks together.
Diagnostics validate(const Robot& robot, const std::vector<Network>& networks);

}  // namespace segue::model

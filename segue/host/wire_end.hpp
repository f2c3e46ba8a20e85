// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/model/component.hpp>
#include <segue/model/network.hpp>
#include <segue/task/component.hpp>
#include <segue/task/held_ports.hpp>

namespace segue::host::detail {

/// One end of a connection: a task, whose component stays meanwhile.
struct WireEnd {
  task::Component& component;
  bool stand_in = false;
  bool configured = false;
};

/// Gives a stand-in the port if it lacks it; other components have theirs or not. Not while ports are held.
Result<void> grow(const WireEnd& end, const model::PortRef& ref, model::Direction direction);

/// The port, valid as long as `ports` holds it. NotFound names the ports that there are.
Result<task::OutputPortBase*> find_output(const task::HeldPorts& ports, const WireEnd& end,
                                          const model::PortRef& ref);
Result<task::InputPortBase*> find_input(const task::HeldPorts& ports, const WireEnd& end,
                                        const model::PortRef& ref);

}  // namespace segue::host::detail

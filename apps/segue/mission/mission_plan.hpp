// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../command.hpp"

namespace segue::cli {

/// A verb of `mission`: PDDL plans as missions of a robot.
void add_mission_plan(Verb& mission, Context& context);

}  // namespace segue::cli

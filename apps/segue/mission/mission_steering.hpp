// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../command.hpp"

namespace segue::cli {

/// `segue mission status`, `pause`, `resume`, `stop`, `step`, `break`, `go-on-at` and `values`: of the
/// mission that commands a robot, wherever it runs.
void add_mission_steering(Verb& mission, Context& context);

}  // namespace segue::cli

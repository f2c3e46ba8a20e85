// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace segue {

/// The robot whose tasks this process runs, by its name; empty where nobody has said it, as in tests. Any
/// thread.
std::string robot_of_process();
/// For whoever starts to run a robot's tasks in this process.
void set_robot_of_process(std::string name);

}  // namespace segue

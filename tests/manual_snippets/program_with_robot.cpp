// SPDX-License-Identifier: Apache-2.0
// A function whose `robot` is open.
#include <segue/runtime/embedded_robot.hpp>

void use(segue::Result<segue::runtime::EmbeddedRobot>& robot) {
  // the snippet
}

// SPDX-License-Identifier: Apache-2.0
// A function whose `robot` is open.
#include <segue/runtime/embedded_robot.hpp>

#include <memory>

void use(const segue::Result<std::unique_ptr<segue::runtime::EmbeddedRobot>>& robot) {
  // the snippet
}

// SPDX-License-Identifier: Apache-2.0
// A function that returns a status, where `robot` is open.
#include <segue/components/demo/types.hpp>
#include <segue/runtime/embedded_robot.hpp>

#include <chrono>
#include <iostream>

using demo::Pose;

int use(segue::Result<segue::runtime::EmbeddedRobot>& robot) {
  // the snippet
  return 0;
}

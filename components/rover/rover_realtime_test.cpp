// SPDX-License-Identifier: Apache-2.0
//
// Updates of the simulation and of the drivers allocate nothing, MuJoCo's part included.
#include "test_support.hpp"

#include <support/allocation_trap.hpp>

namespace rover {
namespace {

using segue::type::Value;
using namespace std::chrono_literals;

TEST(RoverRealtime, NoUpdateOfSimulationAndDriversAllocates) {
  testing::SteppedRover rover(Value::map({{"seed", 3}}));
  rover.add("script", "rover::VelocityScript",
            Value::map({{"legs", Value::list({testing::leg(0.5, 0.4, 0), testing::leg(5, 0.2, 0.5)})}}));
  rover.wire("rover", "time", "script", "time");
  rover.wire("script", "command", "wheels", "command");
  rover.add("battery", "rover::Battery");
  rover.wire("rover", "arm_state", "battery", "arm");
  rover.wire("rover", "wheel_state", "battery", "wheels");
  rover.add("button", "rover::StopButton");
  rover.start();
  rover.advance(200ms);
  rover.call("gripper", "open");
  rover.call("arm", "move_to", Value::list({Value::list({0.3, -1.2, 1.6, 0.1, 0.2, 0.3})}));
  segue::testing::trapped = true;
  rover.advance(1s);
  segue::testing::trapped = false;
  EXPECT_EQ(segue::testing::caught, 0);
  segue::testing::trapped = true;
  rover.next<double>("rover", "time");
  segue::testing::trapped = false;
  EXPECT_GT(segue::testing::caught, 0) << "connecting allocates: the trap works";
  EXPECT_EQ(rover.task("wheels").state_name(), "driving");
  EXPECT_EQ(rover.task("gripper").state_name(), "open");
}

}  // namespace
}  // namespace rover

// SPDX-License-Identifier: Apache-2.0
// Whoever commands the wheels of the simulated rover hangs or dies, and the wheels stand still.
#include <gmock/gmock.h>

#include <cmath>
#include <csignal>
#include <memory>
#include <string>

#include "../fault/processes.hpp"
#include "system_test.hpp"

namespace segue::testing {
namespace {

constexpr const char* kRobot =
    "robot: rover\nlibraries: [segue_components_rover]\ncontrollers: [drive.yaml]\n";
/// The rover is one process, and what commands its wheels another.
constexpr const char* kDrive = R"(network: drive
tasks:
  rover: {component: "rover::Simulation", activity: {periodic: 10ms}}
  wheels: {component: "rover::RoverDrive"}
  script:
    component: "rover::VelocityScript"
    properties: {legs: [{duration: 1000.0, linear: 0.0, angular: 0.5}]}
connections:
  - rover.wheel_state -> wheels.measured
  - wheels.wheels -> rover.wheels
  - rover.time -> script.time
  - script.command -> wheels.command
deployments:
  body: {tasks: [rover, wheels]}
  commander: {tasks: [script]}
)";

class RoverCommands : public SystemTest {
 protected:
  void SetUp() override {
    SystemTest::SetUp();
    write("robot.yaml", kRobot);
    write("drive.yaml", kDrive);
    robot_ = std::make_unique<Process>(command({"run", "robot.yaml", "--controller", "drive"}), folder_);
    ASSERT_TRUE(robot_->wait_for("runs (pid"));
    wait_for_controller("drive");
    ASSERT_TRUE(eventually([&] { return turns(); })) << segue({"status"}).output;
  }
  void signal_commander(int signal) const {
    ASSERT_EQ(::kill(deployments_of(folder_ / "runtime").at("commander"), signal), 0);
  }
  /// How fast the rover really turns, rad/s.
  double turn_rate() {
    const auto pose = json({"read", "rover.pose"});
    return pose.find("twist")->find("angular")->as_double();
  }
  bool turns() { return turn_rate() > 0.2; }
  bool stands() { return std::abs(turn_rate()) < 0.01; }
};

TEST_F(RoverCommands, that_hang_stop_the_wheels_until_they_come_again) {
  signal_commander(SIGSTOP);
  EXPECT_TRUE(eventually([&] { return stands(); })) << segue({"status"}).output;
  signal_commander(SIGCONT);
  EXPECT_TRUE(eventually([&] { return turns(); })) << segue({"status"}).output;
}

TEST_F(RoverCommands, that_end_with_their_process_stop_the_wheels) {
  signal_commander(SIGKILL);
  EXPECT_TRUE(eventually([&] { return stands(); })) << segue({"status"}).output;
}

}  // namespace
}  // namespace segue::testing

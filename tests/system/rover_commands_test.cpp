// SPDX-License-Identifier: Apache-2.0
// Whoever commands the wheels of the simulated rover hangs or dies, alone or with the runtime, and the wheels
// stand still.
#include <gmock/gmock.h>

#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <fstream>
#include <iterator>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

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
  wheels: {component: "rover::RoverDrive", properties: {timeout: 150ms}}
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

/// Of all its threads.
std::chrono::milliseconds processor_time_of(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  const std::string stat{std::istreambuf_iterator<char>(file), {}};
  std::istringstream fields(stat.substr(stat.rfind(')') + 1));
  std::vector<std::string> values{std::istream_iterator<std::string>(fields), {}};
  const long ticks = values.size() < 13 ? 0 : std::stol(values[11]) + std::stol(values[12]);
  return std::chrono::milliseconds(ticks * 1000 / ::sysconf(_SC_CLK_TCK));
}

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
  pid_t pid_of(const std::string& process) const { return deployments_of(folder_ / "runtime").at(process); }
  void signal_commander(int signal) const { ASSERT_EQ(::kill(pid_of("commander"), signal), 0); }
  /// While nobody can be asked, the rover shows that it goes on by the processor time that it uses, which
  /// passes more slowly than the time that its wheels wait for a command.
  [[nodiscard]] bool goes_on_for(std::chrono::milliseconds used) const {
    const pid_t body = pid_of("body");
    const auto end = processor_time_of(body) + used;
    return eventually([&] { return processor_time_of(body) >= end; });
  }
  /// How fast the rover really turns, rad/s.
  double turn_rate() {
    const auto pose = json({"read", "rover.pose"});
    return pose.find("twist")->find("angular")->as_double();
  }
  bool turns() { return turn_rate() > 0.2; }
  bool stands() { return std::abs(turn_rate()) < 0.01; }
};

TEST_F(RoverCommands, ThatHangStopTheWheelsUntilTheyComeAgain) {
  signal_commander(SIGSTOP);
  EXPECT_TRUE(eventually([&] { return stands(); })) << segue({"status"}).output;
  signal_commander(SIGCONT);
  EXPECT_TRUE(eventually([&] { return turns(); })) << segue({"status"}).output;
}

TEST_F(RoverCommands, ThatEndWithTheirProcessStopTheWheels) {
  signal_commander(SIGKILL);
  EXPECT_TRUE(eventually([&] { return stands(); })) << segue({"status"}).output;
}

TEST_F(RoverCommands, ThatHangWithTheRuntimeStopTheWheels) {
  robot_->signal(SIGSTOP);
  signal_commander(SIGSTOP);
  EXPECT_TRUE(goes_on_for(std::chrono::milliseconds(500)));
  robot_->signal(SIGCONT);
  EXPECT_TRUE(stands()) << "it has come to rest before anybody could look: " << segue({"status"}).output;
  signal_commander(SIGCONT);
  EXPECT_TRUE(eventually([&] { return turns(); })) << segue({"status"}).output;
}

TEST_F(RoverCommands, ThatEndWithTheRuntimeStopTheWheels) {
  robot_->signal(SIGKILL);
  signal_commander(SIGKILL);
  EXPECT_EQ(robot_->wait().status, 128 + SIGKILL);
  EXPECT_TRUE(goes_on_for(std::chrono::milliseconds(500)));
  robot_ = std::make_unique<Process>(command({"run", "robot.yaml"}), folder_);
  ASSERT_TRUE(robot_->wait_for("runs (pid"));
  EXPECT_TRUE(stands()) << "it has come to rest before anybody could look: " << segue({"status"}).output;
}

}  // namespace
}  // namespace segue::testing

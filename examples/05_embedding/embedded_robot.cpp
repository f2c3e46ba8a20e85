// SPDX-License-Identifier: Apache-2.0
// A robot inside a program: opens a robot file, switches through the named controllers, and reads a port.
//   embedded_robot ROBOT_FILE CONTROLLER...
#include <segue/runtime/embedded_robot.hpp>
#include <segue/type/json.hpp>

#include <chrono>
#include <cstdio>
#include <string>
#include <thread>

using namespace segue;

namespace {

int fail_with(const std::string& message) {
  std::fprintf(stderr, "%s\n", message.c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return fail_with("usage: embedded_robot ROBOT_FILE CONTROLLER...");
  auto robot = runtime::EmbeddedRobot::open(argv[1]);
  if (!robot) return fail_with(to_string(diagnostics_of(robot.error())));

  for (int i = 2; i < argc; ++i) {
    const auto result = robot->switch_to(argv[i]);
    if (!result.ok()) return fail_with(result.why());
    std::printf("%s runs after %zu actions\n", argv[i], result.actions.size());
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    const auto pose = robot->port("odometry.pose").next(std::chrono::seconds(10));
    if (!pose) return fail_with(to_string(pose.error()));
    std::printf("pose: %s\n", type::to_json(*pose, -1).c_str());
  }
  return robot->shut_down().ok() ? 0 : 1;
}

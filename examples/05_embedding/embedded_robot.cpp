// SPDX-License-Identifier: Apache-2.0
// A robot inside a program: opens a robot file, switches through the named controllers, and reads a port.
//   embedded_robot ROBOT_FILE CONTROLLER...
#include <segue/runtime/embedded_robot.hpp>
#include <segue/type/json.hpp>

#include <cstdio>
#include <string>
#include <thread>

using namespace segue;

namespace {

int fail_with(const std::string& message) {
  std::fprintf(stderr, "%s\n", message.c_str());
  return 1;
}

/// The next sample of the port; empty if none arrives within ten seconds.
std::string next_sample(task_host::TaskHost& host, const model::PortRef& port) {
  auto reader = host.open_reader(port, 1);
  if (!reader) return to_string(reader.error());
  for (int attempt = 0; attempt < 1000; ++attempt) {
    if (const auto samples = (*reader)->read(1); !samples.empty()) return type::to_json(samples.front(), -1);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return fail_with("usage: embedded_robot ROBOT_FILE CONTROLLER...");
  auto robot = runtime::EmbeddedRobot::open(argv[1]);
  if (!robot) return fail_with(to_string(robot.error()));

  for (int i = 2; i < argc; ++i) {
    const runtime::SwitchResult result = (*robot)->switch_to(argv[i]);
    if (result.error) return fail_with(to_string(*result.error));
    std::printf("%s runs after %zu actions\n", argv[i], result.actions.size());
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    std::printf("pose: %s\n", next_sample((*robot)->host(), {model::TaskId("odometry"), "pose"}).c_str());
  }
  return (*robot)->shut_down().outcome == runtime::Outcome::Done ? 0 : 1;
}

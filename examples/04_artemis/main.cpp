// SPDX-License-Identifier: Apache-2.0
// The main demo: a robot with four controllers makes all twelve transitions between them while samples flow
// between its 8 to 17 processes. Stand-ins (simulated components) replace the rover's drivers.
#include "report.hpp"

#include <segue/runtime/embedded_robot.hpp>

#include <array>
#include <cstdio>
#include <cstring>
#include <span>
#include <string>
#include <thread>
#include <vector>

namespace {

using namespace segue;

// An Eulerian circuit of the four controllers: every transition once, each starting where the last one ended.
constexpr std::array<const char*, 13> kWalk = {
    "search_explore",     "goal_navigation",    "search_explore", "manipulation",    "search_explore",
    "manipulator_teleop", "goal_navigation",    "manipulation",   "goal_navigation", "manipulator_teleop",
    "manipulation",       "manipulator_teleop", "search_explore"};

// How long each controller runs, so that samples flow visibly.
constexpr auto kStay = std::chrono::milliseconds(250);

int walk(runtime::EmbeddedRobot& robot, demo::Report& report) {
  report.introduce(robot);
  const runtime::SwitchResult begun = robot.switch_to(kWalk.front());
  if (!report.started(begun)) return 1;
  report.check_processes(robot);
  std::this_thread::sleep_for(kStay);
  for (const char* target : std::span(kWalk).subspan(1)) {
    const demo::Flow before = demo::measure_flow(robot);
    const runtime::SwitchResult result = robot.switch_to(target);
    if (!report.switched(result, before, demo::measure_flow(robot))) return 1;
    report.check_processes(robot);
    std::this_thread::sleep_for(kStay);
    report.flowed(demo::measure_flow(robot));
  }
  report.ended(robot.shut_down());
  report.check_processes(robot);
  return report.summarise() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  bool everything = false;
  bool in_process = false;
  bool understood = argc >= 2;
  for (int i = 2; i < argc; ++i) {
    everything = everything || std::strcmp(argv[i], "--all") == 0;
    in_process = in_process || std::strcmp(argv[i], "--in-process") == 0;
    understood =
        understood && (std::strcmp(argv[i], "--all") == 0 || std::strcmp(argv[i], "--in-process") == 0);
  }
  if (!understood) {
    std::fputs(
        "usage: artemis_demo ROBOT_FILE [--all] [--in-process]\n"
        "  --all         print every action, not the first of each kind\n"
        "  --in-process  all tasks in this one process\n",
        stderr);
    return 2;
  }
  Diagnostics diagnostics;
  runtime::EmbeddedOptions options;
  options.stand_in = true;
  options.placement = in_process ? runtime::TaskPlacement::InProcess : runtime::TaskPlacement::Processes;
  const auto robot = runtime::EmbeddedRobot::open(argv[1], diagnostics, options);
  if (!robot) {
    std::fputs(to_string(diagnostics).c_str(), stderr);
    return 1;
  }
  auto report = demo::Report::create(robot->robot().folder / "table7.yaml", everything, in_process);
  if (!report) {
    std::fprintf(stderr, "%s\n", to_string(report.error()).c_str());
    return 1;
  }
  return walk(*robot, *report);
}

// SPDX-License-Identifier: Apache-2.0
// The main demo: a robot with four controllers makes all twelve transitions between them while samples flow
// between its 8 to 17 processes, on this computer or on several hosts. Stand-ins (simulated components)
// replace the rover's drivers.
#include "hosts.hpp"
#include "report.hpp"

#include <segue/runtime/embedded_robot.hpp>

#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
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

volatile std::sig_atomic_t interrupted = 0;

/// The first signal ends the walk after the present transition; the next one ends this program at once.
void end_on_signals() {
  struct sigaction action {};
  action.sa_handler = [](int) { interrupted = 1; };
  action.sa_flags = SA_RESTART | static_cast<int>(SA_RESETHAND);
  for (const int signal : {SIGINT, SIGTERM})
    ::sigaction(signal, &action, nullptr);
}

/// Makes all transitions, unless it is interrupted; false where one fails.
bool make_transitions(runtime::EmbeddedRobot& robot, demo::Report& report) {
  for (const char* target : std::span(kWalk).subspan(1)) {
    if (interrupted != 0) break;
    const demo::Flow before = demo::measure_flow(robot);
    const runtime::SwitchResult result = robot.switch_to(target);
    if (!report.switched(result, before, demo::measure_flow(robot))) return false;
    report.check_processes(robot);
    std::this_thread::sleep_for(kStay);
    report.flowed(demo::measure_flow(robot));
  }
  return true;
}

int walk(runtime::EmbeddedRobot& robot, demo::Report& report) {
  report.introduce(robot);
  const runtime::SwitchResult begun = robot.switch_to(kWalk.front());
  if (!report.started(begun)) return 1;
  report.check_processes(robot);
  std::this_thread::sleep_for(kStay);
  if (!make_transitions(robot, report)) return 1;
  report.ended(robot.shut_down());
  report.check_processes(robot);
  if (interrupted != 0) {
    std::fputs("interrupted; everything is shut down\n", stderr);
    return 1;
  }
  return report.summarise() ? 0 : 1;
}

struct Arguments {
  const char* robot_file = nullptr;
  bool everything = false;
  bool in_process = false;
  std::size_t hosts = 0;  ///< 0: only this computer
};

constexpr unsigned long kMostHosts = 9;

/// Nothing where they are not understood.
std::optional<Arguments> read_arguments(std::span<char*> words) {
  if (words.size() < 2) return std::nullopt;
  Arguments arguments;
  arguments.robot_file = words[1];
  for (std::size_t i = 2; i < words.size(); ++i) {
    const std::string word = words[i];
    if (word == "--all") {
      arguments.everything = true;
    } else if (word == "--in-process") {
      arguments.in_process = true;
    } else if (word == "--hosts" && i + 1 < words.size()) {
      arguments.hosts = std::strtoul(words[++i], nullptr, 10);
      if (arguments.hosts < 1 || arguments.hosts > kMostHosts) return std::nullopt;
    } else {
      return std::nullopt;
    }
  }
  if (arguments.in_process && arguments.hosts > 0) return std::nullopt;
  return arguments;
}

int run(const Arguments& arguments) {
  demo::Hosts hosts;
  std::filesystem::path file = arguments.robot_file;
  const std::filesystem::path table = file.parent_path() / "table7.yaml";
  if (arguments.hosts > 0) {
    if (const auto started = hosts.start(arguments.hosts, file); !started) {
      std::fprintf(stderr, "%s\n", to_string(started.error()).c_str());
      return 1;
    }
    file = hosts.robot_file();
  }
  runtime::EmbeddedOptions options;
  options.stand_in = true;
  options.placement =
      arguments.in_process ? runtime::TaskPlacement::InProcess : runtime::TaskPlacement::Processes;
  auto robot = runtime::EmbeddedRobot::open(file, options);
  if (!robot) {
    std::fputs(to_string(diagnostics_of(robot.error())).c_str(), stderr);
    return 1;
  }
  auto report = demo::Report::create(table, arguments.everything, arguments.in_process, hosts.names());
  if (!report) {
    std::fprintf(stderr, "%s\n", to_string(report.error()).c_str());
    return 1;
  }
  return walk(*robot, *report);
}

}  // namespace

int main(int argc, char** argv) {
  const auto arguments = read_arguments({argv, static_cast<std::size_t>(argc)});
  if (!arguments) {
    std::fputs(
        "usage: artemis_demo ROBOT_FILE [--all] [--in-process | --hosts N]\n"
        "  --all         print every action, not the first of each kind\n"
        "  --in-process  all tasks in this one process\n"
        "  --hosts N     the processes dealt out to N hosts (1 to 9), which are daemons on this computer\n",
        stderr);
    return 2;
  }
  end_on_signals();
  return run(*arguments);
}

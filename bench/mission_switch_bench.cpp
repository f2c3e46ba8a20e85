// SPDX-License-Identifier: Apache-2.0
// Switches within a mission, with look-ahead and without: a mission goes through the twelve transitions of
// the Artemis rover, whose actions take time; the times are those of the robot's journal.
//
//   mission_switch_bench [SECONDS]      how long each controller is used (default 2)
#include "support/robot.hpp"

#include <segue/journal/journal_reader.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission_robot/controller_runner.hpp>
#include <segue/mission_run/loaded_mission.hpp>
#include <segue/remote_robot/served_robot.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/runtime/runtime_service.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

namespace {

using namespace bench;
using namespace segue;

constexpr const char* kArtemis = SEGUE_SOURCE_DIR "/examples/04_artemis/robot.yaml";
/// Every ordered pair of the four once.
constexpr std::array kRound = {
    "search_explore",     "goal_navigation",    "search_explore", "manipulation",    "search_explore",
    "manipulator_teleop", "goal_navigation",    "manipulation",   "goal_navigation", "manipulator_teleop",
    "manipulation",       "manipulator_teleop", "search_explore"};
/// Durations from the paper's Table 6: cameras take long, other tasks tens of milliseconds.
constexpr const char* kDurations = R"(stand_ins:
  default: {configure: 20ms, start: 3ms, stop: 8ms, cleanup: 5ms, rate: 0}
  camera_usb::Task: {configure: 150ms, start: 30ms, stop: 1.3s, cleanup: 20ms, rate: 0}
)";

std::string mission_text(double seconds) {
  std::string actions;
  std::string states;
  for (std::size_t i = 0; i < kRound.size(); ++i) {
    actions += fmt::format(
        "  use{}: {{expect: {{duration: {}s}}, run: {{controller: {}, until: [{{after: {}s, outcome: "
        "success}}]}}}}\n",
        i, seconds, kRound.at(i), seconds);
    const std::string next =
        i + 1 < kRound.size() ? fmt::format("use{}", i + 1) : std::string("return success");
    states += fmt::format("  use{}: {{on: {{success: {}}}}}\n", i, next);
  }
  return "mission: round\nactions:\n" + actions + "start: use0\nstates:\n" + states;
}

void carry_out(runtime::Runtime& runtime, std::size_t look_ahead, double seconds) {
  runtime::RuntimeService service(runtime, nullptr, [] {});
  Diagnostics diagnostics;
  auto mission = mission::read_mission(mission_text(seconds), "round.yaml", diagnostics);
  const auto plan = mission_run::LoadedMission::create(std::move(mission).value()).value();
  mission_run::RunRequest request;
  request.runners.set_controllers(std::make_shared<mission::ControllerRunner>(
      std::make_shared<remote_robot::ServedRobot>(service, "the mission"),
      mission::ControllerOptions{.look_ahead = look_ahead}));
  const auto run = plan.run(request);
  if (run && (*run)->overview().succeeded) return;
  std::fprintf(stderr, "the mission failed\n");
  std::exit(1);
}

/// The transitions that the mission requested, but for the first.
std::vector<journal::TransitionEntry> run_mission(std::size_t look_ahead, double seconds) {
  const Scratch scratch;
  runtime::EmbeddedOptions options;
  options.stand_in = true;
  options.stand_ins = scratch.write("durations.yaml", kDurations);
  options.journal = true;
  options.journal_file = scratch.path() / "journal";
  {
    auto robot = open(kArtemis, options);
    carry_out(robot.runtime(), look_ahead, seconds);
    done(robot.shut_down());
  }
  auto reader = journal::JournalReader::open(options.journal_file).value();
  auto entries = reader.transitions(std::numeric_limits<std::size_t>::max()).value();
  std::erase_if(entries, [](const journal::TransitionEntry& entry) {
    return entry.cause != "request" || entry.from.empty() || entry.to.empty();
  });
  return entries;
}

double ms(Duration duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

}  // namespace

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 2.0;
  const auto without = run_mission(0, seconds);
  const auto with = run_mission(3, seconds);
  std::printf(
      "\nTransitions of a mission over the Artemis rover's controllers: prepare / commit, "
      "ms\n%-42s%22s%22s\n",
      "", "without look-ahead", "with look-ahead");
  for (std::size_t i = 0; i < std::min(without.size(), with.size()); ++i) {
    std::printf("%-42s", (without[i].from + " -> " + without[i].to).c_str());
    for (const auto* entry : {&without[i], &with[i]})
      std::printf("%12.1f /%8.1f", ms(entry->prepare), ms(entry->commit));
    std::printf("\n");
  }
  return 0;
}

// SPDX-License-Identifier: Apache-2.0
// A mission inside a program: loads a mission file, executes some of its actions in C++, follows its
// progress, and draws what it did.
//   mission_run MISSION_FILE [SVG_FILE]
#include <segue/draw/gantt.hpp>
#include <segue/mission_run/loaded_mission.hpp>

#include <cstdio>
#include <fstream>
#include <string>

using namespace segue;

namespace {

int fail_with(const std::string& message) {
  std::fprintf(stderr, "%s\n", message.c_str());
  return 1;
}

/// An action in C++: it reads inputs and outputs by name, and ends with an outcome.
mission::Ending weigh(mission::ActionCall& call) {
  const double grams = call.input("grams").as_double();
  call.set_output("heavy", grams > 500);
  if (grams <= 0) return {mission::kAborted, "the scales show nothing"};
  return {call.outcome("weighed").value_or(mission::kAborted), {}};
}

void show(const mission::StateEvent& event) {
  if (event.kind == mission::StateEvent::Kind::Began) return;
  std::printf("%.*s: %.*s\n", static_cast<int>(event.path.size()), event.path.data(),
              static_cast<int>(event.outcome.size()), event.outcome.data());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return fail_with("usage: mission_run MISSION_FILE [SVG_FILE]");
  const auto mission = mission_run::LoadedMission::load(argv[1]);
  if (!mission) return fail_with(to_string(diagnostics_of(mission.error())));

  mission_run::RunRequest request;
  request.mode = mission_run::Concurrent{};
  request.clock = mission_run::RunClock::Virtual;  // simulated actions take no time
  request.runners.add("weigh", weigh);
  request.on_event = show;
  std::stop_source stop;  // request_stop(), on any thread, preempts what is running
  const auto run = mission->run(request, stop.get_token());
  if (!run) return fail_with(to_string(run.error()));

  const mission_run::RunOverview& overview = (*run)->overview();
  const auto seconds = [](Duration time) { return std::chrono::duration<double>(time).count(); };
  std::printf("%s: %s after %.1f s, sequentially %.1f s\n", overview.name.c_str(), overview.outcome.c_str(),
              seconds(overview.makespan), seconds((*run)->comparison().sequential));
  if (argc > 2) std::ofstream(argv[2]) << draw::to_svg((*run)->gantt());
  return overview.succeeded ? 0 : 1;
}

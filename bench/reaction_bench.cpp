// SPDX-License-Identifier: Apache-2.0
// How quickly a mission reacts to what a task says, and what it costs to watch one. The chain is a user's: a
// task in a process of its own, the runtime, and the mission behind the robot's socket.
//
//   reaction_bench [load]       beside as many busy programs as there are processors, which are not nice
#include "support/floor.hpp"
#include "support/measure.hpp"
#include "support/robot.hpp"

#include <segue/control/server.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission_robot/controller_runner.hpp>
#include <segue/mission_run/loaded_mission.hpp>
#include <segue/remote_robot/served_robot.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/runtime/runtime_service.hpp>

#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace {

using namespace bench;
using namespace segue;

constexpr int kGoals = 400;
constexpr Duration kWatched = std::chrono::seconds(5);
constexpr Duration kLong = std::chrono::seconds(60);

[[noreturn]] void give_up(const std::string& why) {
  std::fprintf(stderr, "%s\n", why.c_str());
  std::exit(1);
}

/// The processor time of this process: the runtime, and the mission's side of its socket.
Duration processor_time() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto of = [](const timeval& time) {
    return std::chrono::seconds(time.tv_sec) + std::chrono::microseconds(time.tv_usec);
  };
  return of(usage.ru_utime) + of(usage.ru_stime);
}

void keep_processors_busy() {
  const unsigned count = std::max(1U, std::thread::hardware_concurrency());
  for (unsigned i = 0; i < count; ++i) {
    const pid_t pid = ::fork();
    if (pid < 0) give_up("cannot fork");
    if (pid > 0) continue;
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    for (;;)
      asm volatile("");
  }
}

const char* const kRobot =
    "robot: segue-reaction-bench\n"
    "hosts: {localhost: local}\n"
    "libraries: [segue_components_bench]\n"
    "controllers: [drive.yaml]\n";
const char* const kController =
    "network: drive\n"
    "tasks:\n"
    "  driver: {component: bench::Driver}\n"
    "deployments:\n"
    "  wheels: {tasks: [driver]}\n";

/// `updates`: that each way takes; 0: ways differ.
std::string mission_text(int goals, std::int64_t updates) {
  std::string states;
  for (int i = 0; i < goals; ++i) {
    const std::string next = i + 1 < goals ? "go" + std::to_string(i + 1) : "return success";
    states += "  go" + std::to_string(i) + ": {action: go, on: {success: " + next + "}}\n";
  }
  return "mission: round\n"
         "actions:\n"
         "  go: {run: {controller: drive, set: {driver.updates: " +
         std::to_string(updates) +
         "}, call: {driver.go: {}}, until: [{task: driver, state: arrived, "
         "outcome: success}]}}\n"
         "start: go0\nstates:\n" +
         states;
}

void carry_out(control::RobotService& service, int goals, std::int64_t updates) {
  Diagnostics diagnostics;
  auto mission = mission::read_mission(mission_text(goals, updates), "round.yaml", diagnostics);
  if (!mission) give_up(to_string(diagnostics));
  const auto plan = mission_run::LoadedMission::create(std::move(mission).value()).value();
  mission_run::RunRequest request;
  request.runners.set_controllers(std::make_shared<mission::ControllerRunner>(
      std::make_shared<remote_robot::ServedRobot>(service, "the mission"), mission::ControllerOptions{}));
  const auto run = plan.run(request);
  if (!run || !(*run)->overview().succeeded) give_up("the mission failed");
}

/// The share of one processor that this process uses while `work` is done.
template <class Work>
double share(Work work) {
  const TimePoint begin = RealClock::instance().now();
  const Duration before = processor_time();
  work();
  const std::chrono::duration<double> used = processor_time() - before;
  return used / std::chrono::duration<double>(RealClock::instance().now() - begin);
}

}  // namespace

int main(int argc, char** argv) {
  ::setenv("SEGUE_LIBRARY_PATH", SEGUE_BENCH_LIBRARIES, 0);
  ::setenv("SEGUE_DEPLOYMENT", SEGUE_BENCH_DEPLOYMENT, 0);
  const Scratch scratch;
  scratch.write("drive.yaml", kController);
  runtime::EmbeddedOptions options;
  options.placement = runtime::TaskPlacement::Processes;
  options.log_level = LogLevel::Error;
  auto robot = open(scratch.write("robot.yaml", kRobot), options);
  done(robot.runtime().switch_to(model::NetworkName("drive")));
  runtime::RuntimeService offered(robot.runtime(), nullptr, [] {});
  const auto server = control::Server::listen(scratch.path() / "robot.sock", &offered);
  if (!server) give_up(to_string(server.error()));
  const auto service = control::connect(scratch.path() / "robot.sock");
  if (!service) give_up(to_string(service.error()));
  const bool loaded = argc > 1 && std::string_view(argv[1]) == "load";
  if (loaded) keep_processors_busy();

  const double rest = share([] { std::this_thread::sleep_for(kWatched); });
  const auto updates = std::chrono::duration_cast<std::chrono::milliseconds>(kWatched).count();
  const TimePoint deadline = RealClock::instance().now() + kLong;
  const double watched = share([&] { carry_out(**service, 1, updates); });
  carry_out(**service, kGoals, 0);
  const auto reactions = (*service)->call("driver", "reactions", type::Value::map({}), {"bench"}, deadline);
  if (!reactions || !reactions->is_list()) give_up("the driver does not say how long it waited");
  std::vector<Duration> durations;
  for (const type::Value& one : reactions->as_list())
    durations.push_back(std::chrono::duration_cast<Duration>(std::chrono::duration<double>(one.as_double())));
  // The first goal came after a pause of this program's.
  if (!durations.empty()) durations.erase(durations.begin());

  Table table(loaded ? "From a task's state to the mission's next command, processors busy"
                     : "From a task's state to the mission's next command");
  // Task, runtime, mission, runtime, task: as few threads as can be.
  const Summary floor = idle_socket_chain(3, kGoals, std::nullopt);
  table.add("floor: a byte through bare threads, across processors", floor, 1, floor.median);
  table.add("the same on one processor", idle_socket_chain(3, kGoals, 0), 1, floor.median);
  table.add("through the robot's socket", summarise(durations), 1, floor.median);
  char text[96];
  std::snprintf(text, sizeof text, "%.2f %% of a processor; at rest %.2f %%", 100 * watched, 100 * rest);
  table.note("runtime and mission while one action is watched", text);
  table.print();
  done(robot.shut_down());
}

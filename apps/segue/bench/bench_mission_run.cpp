// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/program.hpp>
#include <segue/mission_run/loaded_mission.hpp>
#include <segue/runtime/controller_files.hpp>
#include <segue/runtime/embedded_robot.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/runtime/runtime_service.hpp>

#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <variant>

#include "../connection.hpp"
#include "../mission/mission_run.hpp"
#include "../output.hpp"
#include "bench_mission.hpp"
#include "bench_mission_trace.hpp"

namespace segue::cli {

namespace {

using mission_run::LoadedMission;
using mission_run::RunRequest;

/// A setting, divided into changes of the robot and inputs of the mission.
struct DealtOut {
  model::RobotChanges robot;
  type::ValueMap inputs;
};

DealtOut deal_out(const MissionExperiment& experiment, const MissionSetting& setting, std::uint64_t seed) {
  DealtOut dealt;
  dealt.inputs = experiment.inputs;
  for (std::size_t i = 0; i < setting.size(); ++i) {
    const MissionFactor& factor = experiment.factors[i];
    switch (factor.kind) {
      case MissionFactor::Kind::Input:
        dealt.inputs.set(factor.name, setting[i]);
        break;
      case MissionFactor::Kind::Property:
        dealt.robot.properties.emplace_back(factor.name, setting[i]);
        break;
      case MissionFactor::Kind::PoolSize:
        dealt.robot.pool_sizes.emplace_back(factor.name, static_cast<int>(setting[i].as_int()));
        break;
    }
  }
  for (const std::string& name : experiment.seeds) {
    if (name.find('.') == std::string::npos) {
      dealt.inputs.set(name, type::Value(seed));
    } else {
      dealt.robot.properties.emplace_back(name, type::Value(seed));
    }
  }
  return dealt;
}

/// A robot in this process, whose deployments and pools are processes. Its destructor stops it.
class FreshRobot {
 public:
  static Result<std::unique_ptr<FreshRobot>> start(const std::filesystem::path& file,
                                                   model::RobotChanges changes) {
    runtime::EmbeddedOptions options;
    options.placement = runtime::TaskPlacement::Processes;
    options.log_level = LogLevel::Error;
    options.changes = std::move(changes);
    auto opened = runtime::EmbeddedRobot::open(file, options);
    if (!opened) return opened.error();
    return std::unique_ptr<FreshRobot>(new FreshRobot(std::move(*opened)));
  }
  ~FreshRobot() {
    served_.reset();  // with its lease
    const auto ended = robot_.shut_down();
    if (!ended.ok()) print_note("the robot did not stop cleanly: " + ended.why());
  }
  FreshRobot(const FreshRobot&) = delete;
  FreshRobot& operator=(const FreshRobot&) = delete;

  [[nodiscard]] const std::shared_ptr<remote_robot::ServedRobot>& served() const { return served_; }

  /// Blocks until every instance of its pools is ready, so that their start is not part of a makespan.
  Result<void> wait_for_pools(const std::stop_token& stop) {
    const TimePoint deadline = deadline_in(std::chrono::seconds(60));
    while (true) {
      const auto pools = served_->pools(Wait(TimePoint::max(), stop));
      if (!pools) return pools.error();
      std::string missing;
      for (const mission::PoolView& pool : *pools) {
        for (const mission::PoolInstanceView& instance : pool.instances) {
          if (!instance.ready) missing = instance.task + ": " + instance.reason;
        }
      }
      if (missing.empty() || stop.stop_requested()) return {};
      if (monotonic_now() > deadline)
        return fail(ErrorCode::DeadlineExceeded, "a pool is not ready after a minute: " + missing);
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }

 private:
  explicit FreshRobot(runtime::EmbeddedRobot robot)
      : robot_(std::move(robot)),
        service_(robot_.runtime(), &robot_.files(), [] {}),
        served_(std::make_shared<remote_robot::ServedRobot>(service_, sender("bench mission"))) {}

  runtime::EmbeddedRobot robot_;
  runtime::RuntimeService service_;
  std::shared_ptr<remote_robot::ServedRobot> served_;
};

Result<LoadedMission> load_for(const MissionExperiment& experiment, remote_robot::ServedRobot& robot) {
  const auto conflicts = robot.conflicts(Wait(TimePoint::max()));
  if (!conflicts) return conflicts.error();
  auto plan =
      LoadedMission::load(experiment.mission, {.libraries = experiment.libraries, .conflicts = &*conflicts});
  if (!plan) return plan.error();
  if (plan->is_network())
    return fail(ErrorCode::Unsupported, experiment.mission.string() + " is a task network, no mission");
  return std::move(*plan);
}

/// Adds the paths of the states in that state whose actions are calls of pools.
void add_calls_of_pools(const mission::Program& program, mission::StateIndex state, const std::string& path,
                        std::set<std::string, std::less<>>& paths) {
  const mission::CompiledState& node = program.node(state);
  if (mission::is_leaf(node.kind)) {
    if (std::holds_alternative<mission::PoolCall>(program.mission().actions[node.action].run))
      paths.insert(path);
  } else if (node.kind == mission::StateKind::Library) {
    add_calls_of_pools(program, node.library, path, paths);
  }
  for (const mission::StateIndex child : node.children) {
    const std::string& id = program.state(child).id.str();
    add_calls_of_pools(program, child, path.empty() ? id : path + "/" + id, paths);
  }
}

std::set<std::string, std::less<>> calls_of_pools(const mission::Program& program) {
  std::set<std::string, std::less<>> paths;
  add_calls_of_pools(program, 0, "", paths);
  return paths;
}

double seconds_at(TimePoint when) {
  return seconds(when.time_since_epoch());
}

/// The makespan of a concurrent run with these durations, in virtual time.
Result<double> ideal_makespan(const LoadedMission& plan, RunRequest request, const MissionTrace& trace,
                              const std::function<double(TimePoint)>& clock) {
  request.mode = mission_run::Concurrent{};
  request.clock = mission_run::RunClock::Virtual;
  request.scripts.reset();
  request.on_event = {};
  request.runners = {};
  request.runners.run_all_by(trace.replay(clock));
  const auto run = plan.run(request);
  if (!run) return run.error();
  return seconds((*run)->overview().makespan);
}

/// Adds the times of a run by both clocks.
Result<void> take_times(MissionRun& measured, const LoadedMission& plan, const RunRequest& request,
                        const MissionTrace& trace, const RobotClock* clock, TimePoint begin, TimePoint end) {
  const auto wall = ideal_makespan(plan, request, trace, seconds_at);
  if (!wall) return wall.error();
  measured.wall.ideal = *wall;
  if (clock == nullptr) return {};
  const auto from = clock->at(begin);
  const auto to = clock->at(end);
  if (!from || !to) return {};
  const auto robot =
      ideal_makespan(plan, request, trace, [&](TimePoint when) { return clock->at(when).value_or(0); });
  if (!robot) return robot.error();
  measured.robot = MissionTimes{*to - *from, *robot};
  return {};
}

Result<MissionRun> run_on(FreshRobot& robot, const MissionExperiment& experiment, RunRequest request,
                          const std::stop_token& stop) {
  if (auto taken = robot.served()->take(); !taken) return taken.error();
  const auto plan = load_for(experiment, *robot.served());
  if (!plan) return plan.error();
  if (auto ready = robot.wait_for_pools(stop); !ready) return ready.error();
  if (auto given = run_by_robot(request, *plan, robot.served(), {}); !given) return given.error();
  MissionTrace trace(calls_of_pools(*plan->program()));
  request.on_event = [&trace](const mission::StateEvent& event) { trace.observe(event); };
  std::optional<RobotClock> clock;
  if (!experiment.clock.empty()) clock.emplace(robot.served(), experiment.clock);
  const TimePoint begin = monotonic_now();
  const auto run = plan->run(request, stop);
  const TimePoint end = monotonic_now();
  if (!run) return run.error();
  if (clock) clock->stop();
  const mission_run::RunOverview& overview = (*run)->overview();
  MissionRun measured;
  measured.ended_well = overview.succeeded;
  measured.outcome = overview.outcome;
  if (overview.error) measured.error = overview.error->message;
  // By the clock of the trace, so that what was under way in it fits in.
  measured.wall.makespan = seconds(end - begin);
  measured.idle = seconds(trace.idle(begin, end));
  measured.planning = seconds(trace.planning());
  if (!overview.succeeded) return measured;
  if (auto taken = take_times(measured, *plan, request, trace, clock ? &*clock : nullptr, begin, end); !taken)
    return taken.error();
  if (clock && !measured.robot) {
    return fail(ErrorCode::InvalidArgument,
                "the clock " + experiment.clock + " of the robot gave no time: " + clock->error());
  }
  return measured;
}

}  // namespace

Result<MissionRun> run_mission_afresh(const MissionExperiment& experiment, const MissionSetting& setting,
                                      bool concurrent, std::uint64_t seed, const std::stop_token& stop) {
  DealtOut dealt = deal_out(experiment, concurrent ? setting : sequential_setting(experiment, setting), seed);
  auto robot = FreshRobot::start(experiment.robot, std::move(dealt.robot));
  if (!robot) return robot.error();
  RunRequest request;
  if (concurrent) request.mode = mission_run::Concurrent{};
  request.inputs = std::move(dealt.inputs);
  auto measured = run_on(**robot, experiment, std::move(request), stop);
  if (!measured) return measured;
  measured->concurrent = concurrent;
  measured->seed = seed;
  return measured;
}

}  // namespace segue::cli

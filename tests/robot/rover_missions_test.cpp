// SPDX-License-Identifier: Apache-2.0
// Random missions of the rover on stand-ins, whose planners are processes that come, go and are killed: each
// one as it is written, and concurrently. Both must end the same way, in the same world, and no two actions
// may overlap that exclude each other. SEGUE_ROVER_MISSIONS=200 tries as many, SEGUE_SEED=n begins with
// another one.
#include <segue/mission/mission_io.hpp>
#include <segue/mission/pool_actions.hpp>
#include <segue/mission/program.hpp>
#include <segue/mission_robot/controller_runner.hpp>
#include <segue/mission_robot/pool_runner.hpp>
#include <segue/mission_run/loaded_mission.hpp>
#include <segue/remote_robot/served_robot.hpp>
#include <segue/runtime/runtime_service.hpp>
#include <segue/type/json.hpp>

#include <support/number_from.hpp>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>
#include <iostream>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "overlap_check.hpp"
#include "rover_mission.hpp"
#include "rover_on_stand_ins.hpp"

namespace segue::testing {
namespace {

using namespace std::chrono_literals;
using mission::ActionCall;
using mission::ActionRunner;
using mission::Ending;
using type::Value;

/// As many as a call survives of a pool that may have two instances.
constexpr int kMostKills = 2;

std::size_t digest(const std::string& text, std::size_t number = 0) {
  return std::hash<std::string>()(text + std::to_string(number));
}
Duration briefly(std::size_t number) {
  return 1ms * (number % 4);
}

/// Ends as a function of the call says, after a time that it says, too.
class Thoughts final : public ActionRunner {
 public:
  std::optional<Ending> start(ActionCall& call) override {
    const auto world = call.world();
    std::size_t number = digest(call.path() + type::to_json(call.input("n"), -1));
    for (const std::string& fact : world->facts())
      number = digest(fact, number);
    for (const auto& [name, data] : world->data())
      number = digest(name + type::to_json(data->shown(), -1), number);
    call.set_output("n", Value(static_cast<std::int64_t>(number % 4)));
    call.end_after(briefly(number >> 8), {static_cast<mission::Outcome>((number >> 4) % 2), {}});
    return std::nullopt;
  }
};

class Notes final : public ActionRunner {
 public:
  std::optional<Ending> start(ActionCall& call) override {
    const std::size_t number = digest(call.path() + type::to_json(call.input("n"), -1));
    const bool aborts = number % 6 == 0;
    call.end_after(briefly(number >> 8), aborts ? Ending{mission::kAborted, "cannot note it"} : Ending{});
    return std::nullopt;
  }
};

class FinalValues final : public ActionRunner {
 public:
  std::optional<Ending> start(ActionCall& call) override {
    type::ValueMap seen;
    const auto world = call.world();
    for (const auto& [name, data] : world->data())
      seen.append(name, data->shown());
    call.set_output("seen", std::move(seen));
    return Ending{};
  }
};

class Drain final : public ActionRunner {
 public:
  explicit Drain(RobotWithKilledPlanners& robot) : robot_(robot) {}
  std::optional<Ending> start(ActionCall& call) override {
    call.end_after(1h, {});
    robot_.drain_battery();
    return std::nullopt;
  }

 private:
  RobotWithKilledPlanners& robot_;
};

/// What a run has come to.
struct MissionRun {
  std::string end{};      ///< outcome, error, outputs, facts and units, as text
  std::string problem{};  ///< what was wrong; empty: nothing
  int kills = 0;
  int lost_calls = 0;
  int overlaps = 0;
  int repeated = 0;
  std::size_t planners = 0;  ///< how many were used
};

class Trial {
 public:
  explicit Trial(std::uint64_t seed)
      : random_(seed),
        mission_(random_rover_mission(random_)),
        robot_(random_),
        service_(robot_.runtime(), nullptr, [] {}) {}

  MissionRun run(const mission_run::RunMode& mode) {
    MissionRun run;
    const auto served = std::make_shared<remote_robot::ServedRobot>(service_, "the mission");
    EXPECT_TRUE(served->take());
    const auto robot =
        std::make_shared<RobotWithKilledPlanners>(served, random_(), up_to(random_, kMostKills));
    const auto conflicts = robot->conflicts(Wait(TimePoint::max()));
    Diagnostics diagnostics;
    auto mission = mission::read_mission(mission_.text, "random.yaml", diagnostics);
    if (!conflicts || !mission) return {.problem = to_string(diagnostics)};
    const auto plan = mission_run::LoadedMission::create(std::move(*mission), &*conflicts);
    if (!plan) return {.problem = to_string(plan.error())};
    OverlapCheck overlaps(mission_, *conflicts);
    auto request = request_for(*plan, robot);
    request.mode = mode;
    request.on_event = [&](const mission::StateEvent& event) { overlaps.note(event); };
    const auto finished = plan->run(request);
    if (!finished) return {.problem = to_string(finished.error())};
    run.end = end_of((*finished)->to_value());
    const std::string wanted = mission_.gets_low ? "low" : "done";
    const auto& overview = (*finished)->overview();
    if (overview.outcome != wanted)
      run.problem =
          "it ended " + overview.outcome + (overview.error ? ": " + to_string(*overview.error) : "");
    if (const auto forbidden = overlaps.problem()) run.problem = *forbidden;
    run.kills = robot->kills();
    run.lost_calls = robot->lost_calls();
    run.planners = robot->planners().size();
    run.overlaps = overlaps.overlaps();
    run.repeated = overlaps.repeated();
    return run;
  }
  mission_run::Concurrent concurrently() {
    mission_run::Concurrent how;
    how.strict = one_in(random_, 4);
    if (one_in(random_, 4)) how.workers = 6;
    if (one_in(random_, 4)) how.world_copies = 1 + static_cast<std::uint32_t>(up_to(random_, 1));
    if (one_in(random_, 4)) how.ahead = 1 + static_cast<std::uint32_t>(up_to(random_, 2));
    return how;
  }
  [[nodiscard]] const RoverMission& mission() const { return mission_; }
  std::string events() { return robot_.events(); }

 private:
  static mission_run::RunRequest request_for(const mission_run::LoadedMission& plan,
                                             const std::shared_ptr<RobotWithKilledPlanners>& robot) {
    mission_run::RunRequest request;
    const auto pools = robot->pools(Wait(TimePoint::max()));
    EXPECT_TRUE(pools);
    const auto units = mission::pool_units(plan.program()->mission(), *pools);
    EXPECT_TRUE(units) << to_string(units.error());
    request.resources.insert(units->begin(), units->end());
    request.runners.set_pools(
        std::make_shared<mission::PoolRunner>(robot, mission::PoolOptions{.period = 2ms, .notice = 60s}));
    request.runners.set_controllers(
        std::make_shared<mission::ControllerRunner>(robot, mission::ControllerOptions{.period = 1ms}));
    request.runners.add("think", std::make_shared<Thoughts>());
    request.runners.add("note", std::make_shared<Notes>());
    request.runners.add("see", std::make_shared<FinalValues>());
    request.runners.add("drain", std::make_shared<Drain>(*robot));
    return request;
  }

  /// What both runs must have in common, one a line.
  static std::string end_of(const Value& document) {
    std::string text;
    for (const std::string_view part : {"outcome", "error", "outputs", "world"}) {
      const Value* value = document.find(part);
      text += fmt::format("{}: {}\n", part, value == nullptr ? "" : type::to_json(*value, -1));
    }
    std::map<std::string, std::string> units;  // sorted
    for (const auto& [resource, count] : document.find("units")->as_map())
      units.emplace(resource, type::to_json(count, -1));
    for (const auto& [resource, count] : units)
      text += fmt::format("{} {}\n", count, resource);
    return text;
  }

  Random random_;
  const RoverMission mission_;
  RoverOnStandIns robot_;
  runtime::RuntimeService service_;
};

TEST(RoverMissions, DoConcurrentlyWhatTheyDoAsWrittenWhilePlannersAreKilled) {
  const int missions = number_from("SEGUE_ROVER_MISSIONS", 30);
  const int first = number_from("SEGUE_SEED", 1);
  MissionRun all;
  int low = 0;
  for (int seed = first; seed < first + missions; ++seed) {
    Trial trial(static_cast<std::uint64_t>(seed));
    SCOPED_TRACE(fmt::format("SEGUE_SEED={} SEGUE_ROVER_MISSIONS=1\n{}", seed, trial.mission().text));
    const MissionRun written = trial.run(mission_run::Sequential{});
    ASSERT_EQ(written.problem, "") << "as written\n" << written.end << trial.events();
    const MissionRun run = trial.run(trial.concurrently());
    ASSERT_EQ(run.problem, "") << "concurrently\n" << run.end << trial.events();
    ASSERT_EQ(run.end, written.end);
    low += trial.mission().gets_low ? 1 : 0;
    all.kills += written.kills + run.kills;
    all.lost_calls += written.lost_calls + run.lost_calls;
    all.overlaps += run.overlaps;
    all.repeated += run.repeated;
    all.planners = std::max(all.planners, run.planners);
  }
  std::cout << fmt::format(
      "{} missions, {} of them with a low battery: {} planners killed, {} calls lost, {} overlaps of "
      "actions, {} "
      "predictions repeated\n",
      missions, low, all.kills, all.lost_calls, all.overlaps, all.repeated);
  if (missions < 100) return;  // what few missions come to is a matter of time
  EXPECT_GT(low, 0);
  EXPECT_GT(all.kills, 0);
  EXPECT_GT(all.lost_calls, 0);
  EXPECT_GT(all.overlaps, 0);
  EXPECT_GT(all.repeated, 0);
  EXPECT_GT(all.planners, 2U) << "pools never grew";
}

}  // namespace
}  // namespace segue::testing

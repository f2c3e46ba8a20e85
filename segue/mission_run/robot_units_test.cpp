// SPDX-License-Identifier: Apache-2.0
//
// Units that outlive a run, since the robot keeps count of them, in both modes.
#include <segue/mission/unit_keeper.hpp>
#include <segue/mission_run/loaded_mission_test_support.hpp>
#include <segue/mission_run/run_control.hpp>

#include <gmock/gmock.h>

#include <map>
#include <memory>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

namespace segue::mission_run {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

/// A robot that counts each execution of a run with a journal once.
class CountingKeeper final : public mission::UnitKeeper {
 public:
  std::map<std::string, std::int64_t> stock = {{"place", 2}, {"screws", 10}, {"arm", 1}};
  std::vector<std::string> told;  ///< by the last run
  std::vector<std::string> runs;
  mission::UnitCounts begun;
  bool hears = true;  ///< or else what it is told is lost with the mission

  Result<mission::UnitCounts> counts() override {
    mission::UnitCounts counts;
    for (const auto& [name, count] : stock)
      counts.emplace_back(name, static_cast<std::uint32_t>(count));
    return counts;
  }
  Result<void> begin(const std::string& journal, const mission::UnitCounts& counts) override {
    runs.push_back(journal);
    begun = counts;
    told.clear();
    return {};
  }
  void changed(const mission::Execution& execution, const mission::UnitChanges& changes) override {
    if (!hears) return;
    const bool is_new =
        runs.back().empty() ||
        known_.insert(runs.back() + execution.path + execution.loops + std::to_string(execution.iteration))
            .second;
    for (const auto& [name, change] : changes) {
      told.push_back(execution.path + ": " + name + (change > 0 ? " +" : " ") + std::to_string(change));
      if (is_new) stock[name] += change;
    }
  }

 private:
  std::set<std::string> known_;
};

/// Takes a box from the deck to the feeder; whether that goes well, `put` says.
constexpr const char* kLoad = R"j(mission: m
resources:
  place: {of: robot}
  screws: {class: world, of: robot}
  arm: {of: robot}
  room: {count: 3}
actions:
  take: {resources: [{block: arm, keep: true}, {create: place}, {consume: room}], run: {simulated: {duration: 1s}}}
  put:
    inputs: {how: text}
    resources: [{consume: screws, count: 2}, {delete: place}, {release: arm}]
    outcomes: [done, dropped]
    run: {callback: put}
  look: {run: {simulated: {duration: 1s}}}
inputs: {how: {type: text, default: done}}
flows: [inputs.how -> put.how]
outcomes: [done, dropped]
start: take
states:
  take: {on: {success: look}}
  look: {on: {success: put}}
  put: {on: {done: return done, dropped: return dropped, aborted: return dropped}}
)j";

class RobotUnitsOfMissions : public LoadedMissions, public ::testing::WithParamInterface<RunMode> {
 protected:
  RunRequest on_robot() {
    RunRequest wanted = request(GetParam());
    wanted.units = robot_;
    wanted.runners.add("put", [](mission::ActionCall& call) {
      const auto outcome = call.outcome(call.input("how").as_string());
      return mission::Ending{outcome.value_or(mission::kAborted), outcome ? "" : "it broke"};
    });
    return wanted;
  }
  std::string outcome_of(const LoadedMission& plan, const RunRequest& wanted,
                         const std::stop_token& stop = {}) {
    const auto run = plan.run(wanted, stop);
    return run ? (*run)->overview().outcome : run.error().message;
  }

  std::shared_ptr<CountingKeeper> robot_ = std::make_shared<CountingKeeper>();
};

TEST_P(RobotUnitsOfMissions, BeginAsTheLastRunLeftThem) {
  const LoadedMission plan = load("m.yaml", kLoad);
  EXPECT_EQ(outcome_of(plan, on_robot()), "done");
  EXPECT_THAT(robot_->begun, UnorderedElementsAre(::testing::Pair("place", 2), ::testing::Pair("screws", 10),
                                                  ::testing::Pair("arm", 1)));
  EXPECT_THAT(robot_->told, ElementsAre("take: place +1", "put: place -1", "put: screws -2"))
      << "neither the arm, which is only blocked, nor the room, which is the mission's";
  RunRequest other = on_robot();
  other.inputs.set("how", "dropped");
  EXPECT_EQ(outcome_of(plan, other), "dropped");
  EXPECT_THAT(robot_->told, ElementsAre("take: place +1", "put: screws -2"))
      << "what did not end as expected has not deleted anything";
  other.inputs.set("how", "broken");
  EXPECT_EQ(outcome_of(plan, other), "dropped");
  EXPECT_EQ(robot_->stock, (std::map<std::string, std::int64_t>{{"place", 4}, {"screws", 4}, {"arm", 1}}));
  robot_->stock["screws"] = 1;
  EXPECT_EQ(outcome_of(plan, on_robot()), "dropped") << "there are too few";
  EXPECT_THAT(robot_->told, ElementsAre("take: place +1")) << "what may not begin has used nothing up";
}

TEST_P(RobotUnitsOfMissions, OfWhatIsNotOnThePathAreNotUsed) {
  const LoadedMission plan = load("m.yaml", R"j(mission: m
resources: {screws: {of: robot}}
actions:
  choose: {outcomes: [left, right], expect: {outcome: left}, run: {simulated: {duration: 1s, outcomes: [right]}}}
  drill: {pure: true, resources: [{consume: screws}], run: {simulated: {duration: 1s}}}
start: choose
states:
  choose: {on: {left: drill, right: return success}}
  drill: {on: {success: return success}}
)j");
  EXPECT_EQ(outcome_of(plan, on_robot()), "success");
  EXPECT_THAT(robot_->told, IsEmpty());
}

TEST_P(RobotUnitsOfMissions, AreToldOfAnUnhandledAbort) {
  std::string text = kLoad;
  text.replace(text.find(", aborted: return dropped"), 25, "");
  const LoadedMission plan = load("m.yaml", text);
  RunRequest wanted = on_robot();
  wanted.inputs.set("how", "broken");
  EXPECT_EQ(outcome_of(plan, wanted), "aborted");
  EXPECT_THAT(robot_->told, ElementsAre("take: place +1", "put: screws -2"));
}

TEST_P(RobotUnitsOfMissions, ChangeOnceByARoutine) {
  const LoadedMission plan = load("m.yaml", R"j(mission: m
resources: {screws: {of: robot}}
actions:
  drill: {resources: [{consume: screws}], run: {simulated: {duration: 1s}}}
  find: {resources: [{create: screws, count: 5}], run: {simulated: {duration: 1s}}}
start: work
states:
  work:
    routine: true
    start: one
    states:
      one: {action: drill, on: {success: two}}
      two: {action: drill, on: {success: find}}
      find: {on: {success: return success}}
    on: {success: return success}
)j");
  EXPECT_EQ(outcome_of(plan, on_robot()), "success");
  EXPECT_EQ(robot_->stock["screws"], 13);
  if (!is_concurrent(GetParam())) return;
  EXPECT_THAT(robot_->told, ElementsAre("work: screws +3")) << "concurrently it is one execution";
}

/// The mission is killed after its action has ended, and before the robot has heard what that has changed.
TEST_P(RobotUnitsOfMissions, AreToldAgainByAResumedRunAndCountOnce) {
  const LoadedMission plan = load("m.yaml", kLoad);
  for (const bool has_heard : {false, true}) {
    SCOPED_TRACE(has_heard);
    robot_ = std::make_shared<CountingKeeper>();
    robot_->hears = has_heard;
    RunRequest wanted = on_robot();
    wanted.journal = Journal{folder_ / (has_heard ? "heard" : "not_heard")};
    std::stop_source stop;
    wanted.on_event = [&](const mission::StateEvent& event) {
      if (event.kind == mission::StateEvent::Kind::Ended && event.path == "take") stop.request_stop();
    };
    EXPECT_EQ(outcome_of(plan, wanted, stop.get_token()), "preempted");
    EXPECT_EQ(robot_->stock["place"], has_heard ? 3 : 2);
    robot_->hears = true;
    wanted.on_event = {};
    wanted.journal->resume = mission::UnderWay::Again;
    EXPECT_EQ(outcome_of(plan, wanted), "done");
    ASSERT_EQ(robot_->runs.size(), 2U);
    EXPECT_EQ(robot_->runs.front(), robot_->runs.back());
    EXPECT_NE(robot_->runs.front(), "");
    EXPECT_THAT(robot_->begun, ::testing::Contains(::testing::Pair("place", 2))) << "as it began";
    EXPECT_THAT(robot_->told, ElementsAre("take: place +1", "put: place -1", "put: screws -2"));
    EXPECT_EQ(robot_->stock["screws"], 8);
    EXPECT_EQ(robot_->stock["place"], 2);
  }
}

/// A run that is stopped while it uses screws.
TEST_P(RobotUnitsOfMissions, OfAnActionThatBeginsAgainAreNotUsedYet) {
  const LoadedMission plan = load("m.yaml", R"j(mission: m
resources: {screws: {of: robot}}
actions: {drill: {resources: [{consume: screws}], run: {simulated: {duration: 10min}}}}
action: drill
)j");
  for (const bool has_journal : {false, true}) {
    SCOPED_TRACE(has_journal);
    robot_ = std::make_shared<CountingKeeper>();
    RunRequest wanted = on_robot();
    wanted.clock = RunClock::Real;
    if (has_journal) wanted.journal = Journal{folder_ / "journal"};
    std::stop_source stop;
    wanted.on_event = [&](const mission::StateEvent&) { stop.request_stop(); };
    EXPECT_EQ(outcome_of(plan, wanted, stop.get_token()), "preempted");
    EXPECT_EQ(robot_->stock["screws"], has_journal ? 10 : 9);
  }
}

TEST_P(RobotUnitsOfMissions, NeedARobotOrANumber) {
  const LoadedMission plan = load("m.yaml", kLoad);
  RunRequest wanted = on_robot();
  wanted.units = nullptr;
  EXPECT_THAT(outcome_of(plan, wanted),
              HasSubstr("the robot keeps the count of the resource 'place'; for a run "
                        "without a robot the mission must say it"));
  wanted.resources = {{"place", 1}, {"screws", 2}, {"arm", 1}};
  EXPECT_EQ(outcome_of(plan, wanted), "done");
  wanted.units = robot_;
  EXPECT_THAT(outcome_of(plan, wanted), HasSubstr("`segue units set` changes it"));
  wanted.resources.clear();
  robot_->stock.erase("screws");
  EXPECT_THAT(outcome_of(plan, wanted), HasSubstr("the robot keeps no units 'screws'"));
}

INSTANTIATE_TEST_SUITE_P(BothModes, RobotUnitsOfMissions, ::testing::ValuesIn(kBothModes), name_of_mode);

}  // namespace
}  // namespace segue::mission_run

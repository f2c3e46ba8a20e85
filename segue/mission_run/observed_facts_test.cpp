// SPDX-License-Identifier: Apache-2.0
//
// Facts that a mission binds to the robot, in both modes.
#include <segue/mission/mission_io.hpp>
#include <segue/mission/program.hpp>
#include <segue/mission_robot/controller_runner.hpp>
#include <segue/mission_robot/fact_observer.hpp>
#include <segue/mission_robot/fake_commanded_robot.hpp>
#include <segue/mission_run/both_modes.hpp>
#include <segue/mission_run/loaded_mission.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <thread>

namespace segue::mission_run {
namespace {

using namespace std::chrono_literals;
using mission::FakeCommandedRobot;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

/// Nothing is looked at unless the robot has said that it has changed.
constexpr Duration kNever = 1h;

class ObservedFacts : public ::testing::TestWithParam<RunMode> {
 protected:
  /// A mission that observes the planner's task, its port and an operation; `actions` and `states` in YAML.
  void begin(const std::string& actions, const std::string& states, bool simulate = false) {
    const std::string text =
        "mission: m\n"
        "observe:\n"
        "  arrived(): {task: planner, state: arrived, settle: 1ms}\n"
        "  low(): {port: planner.status, where: 'charge < 0.2', settle: 1ms}\n"
        "  failed(): {call: planner.failed, is: true}\n"
        "  gone(): {task: nobody, state: there, settle: 1ms}\n"
        "actions:\n" +
        actions + "outcomes: [done, handled]\n" + states;
    Diagnostics diagnostics;
    auto read = mission::read_mission(text, "m.yaml", diagnostics);
    ASSERT_TRUE(read) << to_string(diagnostics);
    const auto plan = LoadedMission::create(std::move(*read));
    ASSERT_TRUE(plan) << to_string(plan.error());
    RunRequest request;
    request.mode = GetParam();
    request.simulate = simulate;
    mission::ControllerOptions how;
    how.period = 1ms;
    how.look_ahead = 0;
    request.runners.set_controllers(std::make_shared<mission::ControllerRunner>(robot_, how));
    if (!simulate) {
      request.runners.set_observer(std::make_shared<mission::FactObserver>(
          robot_, plan->program()->mission(), mission::FactObserver::Options{.period = kNever}));
    }
    thread_ = std::jthread([this, plan = *plan, request] { run_ = plan.run(request); });
  }
  std::string ended() {
    thread_.join();
    EXPECT_TRUE(run_);
    const RunOverview& overview = (*run_)->overview();
    const bool tells = overview.error && overview.outcome != "handled";
    return overview.outcome + (tells ? ": " + overview.error->message : "");
  }

  std::shared_ptr<FakeCommandedRobot> robot_ = std::make_shared<FakeCommandedRobot>();
  Result<std::unique_ptr<FinishedRun>> run_ = fail(ErrorCode::Internal, "it has not ended");
  std::jthread thread_;
};

constexpr const char* kGo =
    "    run: {controller: go_home, until: [{task: planner, state: arrived}, {task: planner, state: "
    "lost}]}\n";

TEST_P(ObservedFacts, DecideWhetherAnActionBegins) {
  const std::string go = std::string("  go:\n    preconditions: ['arrived()', '!failed()']\n") +
                         "    run: {controller: go_home}\n";
  const std::string states = "start: go\nstates: {go: {on: {success: return done}}}\n";
  begin(go, states);
  EXPECT_THAT(ended(), HasSubstr("aborted: its precondition arrived() does not hold"));
  EXPECT_THAT(robot_->asked(), Not(Contains("request go_home")));
  robot_->become("arrived");
  begin(go, states);
  EXPECT_EQ(ended(), "done");
  robot_->fail_by_call();
  begin(go, states);
  EXPECT_THAT(ended(), HasSubstr("its precondition !failed() does not hold"));
}

TEST_P(ObservedFacts, AreThoseOfAContainerForWhatIsInIt) {
  robot_->show(type::Value::map({{"charge", 0.1}}));
  begin("  go: {run: {controller: go_home}}\n",
        "start: work\n"
        "states:\n"
        "  work:\n"
        "    preconditions: ['!low()']\n"
        "    start: go\n"
        "    states: {go: {on: {success: return success}}}\n"
        "    on: {success: return done, aborted: return handled}\n");
  EXPECT_EQ(ended(), "handled");
}

TEST_P(ObservedFacts, PreemptAnActionThatNeedsThemAllAlong) {
  begin(std::string("  go:\n    while: ['!low()']\n") + kGo + "  rest: {run: {simulated: {}}}\n",
        "start: go\n"
        "states:\n"
        "  go: {on: {success: return done, aborted: rest}}\n"
        "  rest: {on: {success: return handled}}\n");
  robot_->wait_until_asked("request go_home");
  robot_->show(type::Value::map({{"charge", 0.5}}));
  robot_->show(type::Value::map({{"charge", 0.1}}));
  EXPECT_EQ(ended(), "handled");
}

TEST_P(ObservedFacts, OfATaskOrAnOperationPreemptAnAction) {
  for (const std::string fact : {"arrived()", "failed()"}) {
    robot_ = std::make_shared<FakeCommandedRobot>();
    begin("  go:\n    while: ['!" + fact +
              "']\n    run: {controller: go_home, until: [{port: planner.status, where: 'charge > 1'}]}\n",
          "start: go\nstates: {go: {on: {success: return done}}}\n");
    robot_->wait_until_asked("request go_home");
    if (fact == "arrived()") {
      robot_->become("arrived");
    } else {
      robot_->fail_by_call();
    }
    EXPECT_THAT(ended(), HasSubstr("it was preempted, since !" + fact + " does not hold any more"));
  }
}

TEST_P(ObservedFacts, SayWhyTheyPreemptedAnAction) {
  begin(std::string("  go:\n    while: ['!low()']\n") + kGo,
        "start: go\nstates: {go: {on: {success: return done}}}\n");
  robot_->wait_until_asked("request go_home");
  robot_->show(type::Value::map({{"charge", 0.1}}));
  EXPECT_THAT(ended(), HasSubstr("it was preempted, since !low() does not hold any more"));
}

TEST_P(ObservedFacts, ConfirmEffects) {
  const std::string states = "start: go\nstates: {go: {on: {success: return done}}}\n";
  begin("  go:\n    effects: ['+arrived()']\n    run: {simulated: {duration: 2ms}}\n", states);
  EXPECT_THAT(ended(), HasSubstr("aborted: expected arrived(), which did not become true within 1ms"));
  begin("  go:\n    effects: ['-arrived()', '+gone()']\n    run: {controller: go_home}\n", states);
  EXPECT_EQ(ended(), "done") << "what cannot be observed is taken to be as declared";
  begin("  go:\n    effects: ['+failed()']\n    run: {controller: go_home}\n", states);
  robot_->wait_until_asked("request go_home");
  robot_->fail_by_call();
  EXPECT_EQ(ended(), "done");
}

TEST_P(ObservedFacts, ChangeByEffectsWhileTheyCannotBeObserved) {
  begin(
      "  take: {effects: ['+gone()'], run: {simulated: {}}}\n"
      "  use: {preconditions: ['gone()'], run: {simulated: {}}}\n",
      "start: take\n"
      "states: {take: {on: {success: use}}, use: {on: {success: return done}}}\n");
  EXPECT_EQ(ended(), "done");
}

/// A pure action would run on what `go` is expected to change, while `go` does.
TEST_P(ObservedFacts, AreNotTakenToBeAsPredicted) {
  begin(
      "  go: {effects: ['+arrived()'], run: {controller: go_home, until: [{port: planner.status, where: "
      "'charge "
      "> 1'}]}}\n"
      "  think: {pure: true, preconditions: ['arrived()'], run: {simulated: {}}}\n",
      "start: go\n"
      "states: {go: {on: {success: think}}, think: {on: {success: return done}}}\n");
  robot_->wait_until_asked("open planner.status");
  robot_->become("arrived");
  robot_->show(type::Value::map({{"charge", 2}}));
  EXPECT_EQ(ended(), "done");
}

TEST_P(ObservedFacts, AreLikeOthersInASimulation) {
  begin(
      "  take: {effects: ['+arrived()'], run: {controller: go_home}}\n"
      "  use: {preconditions: ['arrived()'], while: ['!low()'], run: {controller: go_home}}\n",
      "start: take\n"
      "states: {take: {on: {success: use}}, use: {on: {success: return done}}}\n",
      true);
  EXPECT_EQ(ended(), "done");
  EXPECT_THAT(robot_->asked(), ElementsAre());
}

INSTANTIATE_TEST_SUITE_P(Modes, ObservedFacts, ::testing::ValuesIn(kBothModes), name_of_mode);

}  // namespace
}  // namespace segue::mission_run

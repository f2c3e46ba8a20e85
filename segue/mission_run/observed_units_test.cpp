// SPDX-License-Identifier: Apache-2.0
//
// Units that a mission binds to the robot, in both modes.
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission/program.hpp>
#include <segue/mission_robot/controller_runner.hpp>
#include <segue/mission_robot/fact_observer.hpp>
#include <segue/mission_robot/fake_commanded_robot.hpp>
#include <segue/mission_run/both_modes.hpp>
#include <segue/mission_run/loaded_mission.hpp>
#include <segue/mission_run/run_control.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

namespace segue::mission_run {
namespace {

using namespace std::chrono_literals;
using mission::FakeCommandedRobot;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

/// The texts that a run tells, for a test that waits for one.
class Told {
 public:
  void add(std::string text) {
    const Lock lock(mutex_);
    all_.push_back(std::move(text));
    added_.notify_all();
  }
  void wait_for(const std::string& text) {
    Lock lock(mutex_);
    EXPECT_TRUE(added_.wait_for(mutex_, 60s, [&]() SEGUE_REQUIRES(mutex_) {
      return std::ranges::any_of(all_, [&](const std::string& one) { return one.find(text) != one.npos; });
    })) << text;
  }
  std::vector<std::string> all() {
    const Lock lock(mutex_);
    return all_;
  }

 private:
  Mutex mutex_;
  ConditionVariable added_;
  std::vector<std::string> all_ SEGUE_GUARDED_BY(mutex_);
};

constexpr const char* kShownByState =
    "resources: {localized: {class: module, observe: {task: planner, state: localized}}}\n";
constexpr const char* kGoOnce =
    "actions:\n"
    "  go: {resources: [{block: localized}], run: {controller: go_home}}\n"
    "start: go\n"
    "states: {go: {on: {success: return success}}}\n";

class ObservedUnits : public ::testing::TestWithParam<RunMode> {
 protected:
  RunRequest request(const LoadedMission& plan) {
    RunRequest request;
    request.mode = GetParam();
    request.note = [told = told_](const std::string& text) { told->add(text); };
    request.on_event = [told = told_](const mission::StateEvent& event) {
      const bool began = event.kind == mission::StateEvent::Kind::Began;
      told->add((began ? "began " : "ended ") + std::string(event.path));
    };
    mission::ControllerOptions how;
    how.period = 1ms;
    how.look_ahead = 0;
    request.runners.set_controllers(std::make_shared<mission::ControllerRunner>(robot_, how));
    request.runners.set_observer(std::make_shared<mission::FactObserver>(
        robot_, plan.program()->mission(), mission::FactObserver::Options{.period = 1h}));
    return request;
  }
  void begin(const std::string& text, const std::function<void(RunRequest&)>& with = {}) {
    Diagnostics diagnostics;
    auto read = mission::read_mission("mission: m\n" + text, "m.yaml", diagnostics);
    ASSERT_TRUE(read) << to_string(diagnostics);
    const auto plan = LoadedMission::create(std::move(*read));
    ASSERT_TRUE(plan) << to_string(plan.error());
    RunRequest asked = request(*plan);
    if (with) with(asked);
    stop_ = std::stop_source();
    run_ = fail(ErrorCode::Internal, "it has not ended");
    thread_ = std::jthread([this, plan = *plan, asked] { run_ = plan.run(asked, stop_.get_token()); });
  }
  std::string ended() {
    thread_.join();
    if (!run_) return run_.error().message;
    const RunOverview& overview = (*run_)->overview();
    return overview.outcome + (overview.error ? ": " + overview.error->message : "");
  }
  void show(bool ok, int step = 0) { robot_->show(type::Value::map({{"ok", ok}, {"step", step}})); }

  std::shared_ptr<FakeCommandedRobot> robot_ = std::make_shared<FakeCommandedRobot>();
  std::shared_ptr<Told> told_ = std::make_shared<Told>();
  Result<std::unique_ptr<FinishedRun>> run_ = fail(ErrorCode::Internal, "it has not ended");
  std::stop_source stop_;
  std::jthread thread_;
};

TEST_P(ObservedUnits, AreWaitedForUntilTheRobotShowsThem) {
  for (const std::string operation : {"block", "exists"}) {
    SCOPED_TRACE(operation);
    robot_ = std::make_shared<FakeCommandedRobot>();
    told_ = std::make_shared<Told>();
    begin(std::string(kShownByState) + "actions:\n  go: {resources: [{" + operation +
          ": localized}], run: {controller: go_home}}\n" +
          "start: go\nstates: {go: {on: {success: return success}}}\n");
    told_->wait_for(
        "go: waits for 1 unit of the resource 'localized', which the robot does not show: task 'planner' is "
        "not "
        "localized");
    EXPECT_THAT(robot_->asked(), Not(Contains("request go_home")));
    robot_->become("localized");
    EXPECT_EQ(ended(), "success");
    EXPECT_THAT(robot_->asked(), Contains("request go_home"));
  }
}

TEST_P(ObservedUnits, AreAsManyAsASampleSays) {
  begin(
      "resources: {processors: {count: 3, observe: {port: planner.load, units: cores.free}}}\n"
      "actions: {think: {resources: [{block: processors, count: 2}], run: {controller: go_home}}}\n"
      "start: think\n"
      "states: {think: {on: {success: return success}}}\n");
  const auto free = [&](double cores) {
    robot_->show(type::Value::map({{"cores", type::Value::map({{"free", cores}})}}));
  };
  free(1.9);
  told_->wait_for("think: waits for 2 units of the resource 'processors', of which the robot shows ");
  EXPECT_THAT(robot_->asked(), Not(Contains("request go_home")));
  free(100);
  EXPECT_EQ(ended(), "success");
}

/// "before" is looked at before "localized"; so once the robot shows it, the others have gone.
TEST_P(ObservedUnits, StayWithWhoHoldsThem) {
  begin(
      "resources:\n"
      "  before: {observe: {port: planner.status, where: 'step == 2'}}\n"
      "  localized: {observe: {port: planner.status, where: 'ok == true'}}\n"
      "actions:\n  done: {run: {decide: [{outcome: success}]}}\n"
      "  hold:\n"
      "    resources: [{block: localized}]\n"
      "    run: {controller: go_home, until: [{task: planner, state: arrived}]}\n"
      "  mark: {resources: [{block: before}], run: {simulated: {}}}\n"
      "  again: {resources: [{block: localized}], run: {simulated: {}}}\n"
      "start: both\n"
      "states:\n"
      "  both:\n"
      "    kind: barrier\n"
      "    states: {hold: {}, mark: {}, done: {kind: decider, on: {success: return success}}}\n"
      "    on: {success: again}\n"
      "  again: {on: {success: return success}}\n");
  show(true, 1);
  robot_->wait_until_asked("request go_home");
  show(false, 2);
  told_->wait_for("ended both/mark");
  robot_->become("arrived");
  told_->wait_for("ended both/hold");
  told_->wait_for("again: waits for 1 unit of the resource 'localized'");
  show(true, 3);
  EXPECT_EQ(ended(), "success");
}

TEST_P(ObservedUnits, AreNotWaitedForOnceTheRunIsStopped) {
  begin(std::string(kShownByState) + kGoOnce);
  told_->wait_for("go: waits");
  stop_.request_stop();
  EXPECT_EQ(ended(), "preempted");
  EXPECT_THAT(robot_->asked(), Not(Contains("request go_home")));
}

TEST_P(ObservedUnits, AreNotWaitedForOnceTheRobotIsLost) {
  begin(std::string(kShownByState) + kGoOnce);
  told_->wait_for("go: waits");
  robot_->take_over();
  EXPECT_EQ(ended(), "aborted: the robot was taken over by somebody");
  EXPECT_THAT(robot_->asked(), Not(Contains("request go_home")));
}

TEST_P(ObservedUnits, ThatDoNotExistAreAShortage) {
  begin(std::string(kShownByState) + kGoOnce, [](RunRequest& asked) {
    asked.resources = {{"localized", 0}};
  });
  EXPECT_EQ(ended(), "aborted: it needs 1 of the resource 'localized', of which there are 0");
}

TEST_P(ObservedUnits, KeepNobodyFromOtherUnits) {
  begin(
      "resources:\n"
      "  localized: {observe: {task: planner, state: localized}}\n"
      "  arm: {commutes: true}\n"
      "actions:\n  done: {run: {decide: [{outcome: success}]}}\n"
      "  use: {resources: [{block: arm}, {block: localized}], run: {simulated: {}}}\n"
      "  find: {resources: [{block: arm}], run: {simulated: {}}}\n"
      "start: both\n"
      "states:\n"
      "  both:\n"
      "    kind: barrier\n"
      "    states: {use: {}, find: {}, done: {kind: decider, on: {success: return success}}}\n"
      "    on: {success: return success}\n");
  told_->wait_for("ended both/find");
  robot_->become("localized");
  EXPECT_EQ(ended(), "success");
}

TEST_P(ObservedUnits, AreWaitedForByAContainer) {
  begin(std::string(kShownByState) +
        "actions:\n"
        "  go: {run: {controller: go_home}}\n"
        "start: work\n"
        "states:\n"
        "  work:\n"
        "    resources: [{block: localized}]\n"
        "    start: go\n"
        "    states: {go: {on: {success: return success}}}\n"
        "    on: {success: return success}\n");
  told_->wait_for("work: waits for 1 unit of the resource 'localized'");
  EXPECT_THAT(robot_->asked(), Not(Contains("request go_home")));
  robot_->become("localized");
  EXPECT_EQ(ended(), "success");
}

/// Beside an action that may touch anything; in a concurrent run, an engine of its own runs both.
TEST_P(ObservedUnits, AreWaitedForBesideWhatMayTouchAnything) {
  begin(std::string(kShownByState) +
        "actions:\n  done: {run: {decide: [{outcome: success}]}}\n"
        "  use: {resources: [{block: localized}], run: {controller: go_home}}\n"
        "  any: {run: {simulated: {}}}\n"
        "start: both\n"
        "states:\n"
        "  both:\n"
        "    kind: barrier\n"
        "    states: {any: {}, use: {}, done: {kind: decider, on: {success: return success}}}\n"
        "    on: {success: return success}\n");
  told_->wait_for("both/use: waits for 1 unit of the resource 'localized'");
  EXPECT_THAT(robot_->asked(), Not(Contains("request go_home")));
  robot_->become("localized");
  EXPECT_EQ(ended(), "success");
}

TEST_P(ObservedUnits, AreNamedByTheReportOfTheRun) {
  begin(std::string(kShownByState) + kGoOnce);
  told_->wait_for("go: waits");
  robot_->become("localized");
  EXPECT_EQ(ended(), "success");
  const type::Value report = (*run_)->to_value();
  const auto& nodes = report.find("nodes")->as_list();
  const auto go = std::ranges::find_if(
      nodes, [](const type::Value& node) { return node.find("name")->as_string().starts_with("go"); });
  ASSERT_NE(go, nodes.end());
  const auto& waits = go->find("waited_for")->as_list();
  const auto found = std::ranges::find_if(
      waits, [](const type::Value& wait) { return wait.find("subject")->as_string() == "localized"; });
  ASSERT_NE(found, waits.end()) << type::to_json(report);
  EXPECT_EQ(found->find("kind")->as_string(), "resource");
  EXPECT_EQ(found->find("node"), nullptr);
  EXPECT_LE(found->find("from_s")->as_double(), found->find("until_s")->as_double());
}

TEST_P(ObservedUnits, AreThereWhereNoRobotIs) {
  begin(std::string(kShownByState) + kGoOnce, [](RunRequest& asked) {
    asked.simulate = true;
    asked.runners.set_observer(nullptr);
  });
  EXPECT_EQ(ended(), "success");
  EXPECT_TRUE(told_->all().empty() || !told_->all().front().starts_with("go: waits"));
}

/// The first of two actions had ended before the run was interrupted, and waits for nothing again.
TEST_P(ObservedUnits, AreOnlyWaitedForByWhatBeginsInAResumedRun) {
  const auto folder = std::filesystem::path(::testing::TempDir()) /
                      (std::string("observed_units_") + (is_concurrent(GetParam()) ? "c" : "s"));
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  const std::string text =
      "resources:\n"
      "  found: {observe: {task: planner, state: found}}\n"
      "  localized: {observe: {port: planner.status, where: 'ok == true'}}\n"
      "actions:\n"
      "  first: {resources: [{block: localized}], run: {simulated: {}}}\n"
      "  second: {resources: [{block: found}], run: {simulated: {}}}\n"
      "start: first\n"
      "states: {first: {on: {success: second}}, second: {on: {success: return success}}}\n";
  show(true);
  begin(text, [&](RunRequest& asked) { asked.journal = Journal{folder / "run", {}}; });
  told_->wait_for("second: waits");
  stop_.request_stop();
  EXPECT_EQ(ended(), "preempted");
  robot_ = std::make_shared<FakeCommandedRobot>();
  told_ = std::make_shared<Told>();
  begin(text, [&](RunRequest& asked) { asked.journal = Journal{folder / "run", mission::UnderWay::Refuse}; });
  told_->wait_for("second: waits");
  robot_->become("found");
  EXPECT_EQ(ended(), "success");
  EXPECT_THAT(told_->all(), Not(Contains(HasSubstr("first: waits"))));
  std::filesystem::remove_all(folder);
}

INSTANTIATE_TEST_SUITE_P(Modes, ObservedUnits, ::testing::ValuesIn(kBothModes), name_of_mode);

}  // namespace
}  // namespace segue::mission_run

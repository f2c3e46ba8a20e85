// SPDX-License-Identifier: Apache-2.0
//
// Missions that go on where an earlier run was interrupted: their actions under way are only watched.
#include <segue/base/file.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission_engine/interrupted_journal.hpp>
#include <segue/mission_robot/controller_runner.hpp>
#include <segue/mission_robot/fake_commanded_robot.hpp>
#include <segue/mission_run/both_modes.hpp>
#include <segue/mission_run/loaded_mission.hpp>

#include <support/eventually.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include <unistd.h>

namespace segue::mission_run {
namespace {

using namespace std::chrono_literals;
using mission::FakeCommandedRobot;
using segue::testing::eventually;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kMission = R"(mission: m
actions:
  go:
    outcomes: [arrived]
    run: {controller: go_home, call: {planner.set_goal: {goal: home}}, until: [{task: planner, state: arrived}]}
outcomes: [arrived]
start: go
states:
  go: {on: {arrived: return arrived}}
)";

class GoingOn : public ::testing::TestWithParam<RunMode> {
 protected:
  GoingOn()
      : folder_(std::filesystem::temp_directory_path() / ("going_on_test." + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
    Diagnostics diagnostics;
    plan_ = LoadedMission::create(mission::read_mission(kMission, "m.yaml", diagnostics).value()).value();
  }
  ~GoingOn() override { std::filesystem::remove_all(folder_); }

  /// `unreachable` stops the run.
  Result<std::string> run(const std::string& journal, bool resume, std::stop_source stop = {}) {
    RunRequest request;
    request.mode = GetParam();
    request.journal = Journal{folder_ / journal};
    if (resume) request.journal->resume = mission::UnderWay::GoOn;
    mission::ControllerOptions how;
    how.period = 1ms;
    how.look_ahead = 0;
    how.unreachable = [&](const Error& /*why*/) { stop.request_stop(); };
    request.runners.set_controllers(std::make_shared<mission::ControllerRunner>(robot_, how));
    const auto run = plan_->run(request, stop.get_token());
    return run ? Result<std::string>((*run)->overview().outcome) : run.error();
  }

  /// Leaves the journal of a run that is killed: it ends with the line that contains `last`.
  void interrupt_after(const std::string& last) {
    std::stop_source stop;
    std::jthread running([&] { EXPECT_TRUE(run("first", false, stop)); });
    std::string text;
    ASSERT_TRUE(eventually([&] {
      text = read_file(folder_ / "first").value_or("");
      return text.find(last) != std::string::npos;
    })) << text;
    stop.request_stop();
    running.join();
    EXPECT_TRUE(write_file((folder_ / "killed").string(),
                           mission::interrupted_journal(text, text.find('\n', text.find(last)) + 1)));
  }

  const std::filesystem::path folder_;
  std::optional<LoadedMission> plan_;
  std::shared_ptr<FakeCommandedRobot> robot_ = std::make_shared<FakeCommandedRobot>();
};

TEST_P(GoingOn, WatchesWhatHasBeenToldAndTellsItNothing) {
  interrupt_after("\"stage\":\"told\"");
  const auto before = robot_->asked();
  EXPECT_THAT(before, ElementsAre("request go_home", "call planner.set_goal home"));
  robot_->become("arrived");
  const auto outcome = run("killed", true);
  ASSERT_TRUE(outcome) << to_string(outcome.error());
  EXPECT_EQ(*outcome, "arrived");
  EXPECT_EQ(robot_->asked(), before);
}

TEST_P(GoingOn, BeginsAnewWhatHadToldNothing) {
  interrupt_after("\"begun\":\"go\"");
  auto expected = robot_->asked();
  expected.insert(expected.end(), {"request go_home", "call planner.set_goal home"});
  robot_->become("arrived");
  EXPECT_EQ(run("killed", true).value_or("refused"), "arrived");
  EXPECT_EQ(robot_->asked(), expected);
}

TEST_P(GoingOn, IsRefusedWhereNobodyCanSeeHowItEnds) {
  interrupt_after("\"stage\":\"tells\"");
  EXPECT_THAT(
      run("killed", true).error().message,
      HasSubstr("'go' had begun but not ended when the run was interrupted, and cannot go on: the run was "
                "interrupted while its controller was being told what to do; choose what to do about it"));
}

TEST_P(GoingOn, IsRefusedWhereTheControllerDoesNotRunAnyMore) {
  interrupt_after("\"stage\":\"told\"");
  robot_->switch_away();
  EXPECT_THAT(run("killed", true).error().message,
              HasSubstr("controller 'go_home' does not run any more: the robot runs explore"));
}

TEST_P(GoingOn, IsWhatARunDoesAfterItsRobotWasUnreachable) {
  std::jthread running([&] { EXPECT_EQ(run("first", false).value_or("refused"), "preempted"); });
  robot_->wait_until_asked("call planner.set_goal home");
  ASSERT_TRUE(eventually(
      [&] { return read_file(folder_ / "first").value_or("").find("\"told\"") != std::string::npos; }));
  robot_->vanish(true);
  running.join();
  robot_->vanish(false);
  robot_->become("arrived");
  EXPECT_EQ(run("first", true).value_or("refused"), "arrived");
  EXPECT_THAT(robot_->asked(), ElementsAre("request go_home", "call planner.set_goal home"));
}

INSTANTIATE_TEST_SUITE_P(Modes, GoingOn, ::testing::ValuesIn(kBothModes), name_of_mode);

}  // namespace
}  // namespace segue::mission_run

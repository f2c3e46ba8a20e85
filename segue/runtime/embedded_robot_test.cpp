// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/base/log.hpp>
#include <segue/runtime/embedded_robot.hpp>
#include <segue/task/component.hpp>

#include <gtest/gtest.h>
#include <unistd.h>

#include <future>
#include <string>

namespace embedded_test {

/// Logs on its update path.
class Speaker final : public segue::task::Component {
 public:
  Speaker() : Component({.activity = segue::periodic(std::chrono::milliseconds(1))}) {}

 private:
  void on_update() override { log(segue::LogLevel::Info, "I am updated"); }
};

}  // namespace embedded_test

SEGUE_COMPONENT(embedded_test::Speaker)

namespace segue::runtime {
namespace {

/// A robot file with one controller, `talk`, of one task of a component of this program.
class EmbeddedRobotTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directory(folder_);
    ASSERT_TRUE(write_file(folder_ / "robot.yaml", "robot: parrot\ncontrollers: [talk.yaml]\n"));
    ASSERT_TRUE(write_file(folder_ / "talk.yaml",
                           "network: talk\ntasks:\n  speaker: {component: embedded_test::Speaker}\n"));
  }
  void TearDown() override {
    set_log_sink({});
    std::filesystem::remove_all(folder_);
  }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("segue_embedded_robot_" + std::to_string(::getpid()));
};

TEST_F(EmbeddedRobotTest, RunsComponentsOfTheProgramItself) {
  auto robot = EmbeddedRobot::open(folder_ / "robot.yaml");
  ASSERT_TRUE(robot) << to_string(robot.error());
  EXPECT_EQ((*robot)->switch_to("talk").outcome, Outcome::Done);
  ASSERT_EQ((*robot)->host().tasks().size(), 1U);
  EXPECT_EQ((*robot)->host().tasks().front().state, TaskState::Running);
  EXPECT_EQ((*robot)->shut_down().outcome, Outcome::Done);
}

TEST_F(EmbeddedRobotTest, ShuttingDownEndsStandby) {
  ASSERT_TRUE(write_file(folder_ / "sing.yaml",
                         "network: sing\ntasks:\n  singer: {component: embedded_test::Speaker}\n"));
  ASSERT_TRUE(write_file(folder_ / "robot.yaml", "robot: parrot\ncontrollers: [talk.yaml, sing.yaml]\n"));
  auto robot = EmbeddedRobot::open(folder_ / "robot.yaml");
  ASSERT_TRUE(robot) << to_string(robot.error());
  ASSERT_EQ((*robot)->switch_to("talk").outcome, Outcome::Done);
  const auto ready = (*robot)->runtime().prepare({model::NetworkName("sing")}).get();
  ASSERT_TRUE(ready.at(0).ready) << ready.at(0).reason;
  EXPECT_EQ((*robot)->host().observe().tasks.size(), 2U);
  EXPECT_EQ((*robot)->shut_down().outcome, Outcome::Done);
  EXPECT_TRUE((*robot)->host().observe().empty());
}

TEST_F(EmbeddedRobotTest, AppliesItsFilesAsTheyAreNow) {
  auto robot = EmbeddedRobot::open(folder_ / "robot.yaml");
  ASSERT_TRUE(robot) << to_string(robot.error());
  ASSERT_EQ((*robot)->switch_to("talk").outcome, Outcome::Done);
  ASSERT_TRUE(write_file(folder_ / "talk.yaml", "network: talk\ntasks: 3\n"));
  const auto refused = (*robot)->apply();
  EXPECT_EQ(refused.outcome, Outcome::Refused);
  EXPECT_TRUE(refused.diagnostics.has_errors());
  EXPECT_EQ((*robot)->files().changes((*robot)->runtime().files()).size(), 1U);
  ASSERT_TRUE(write_file(folder_ / "talk.yaml",
                         "network: talk\ntasks:\n  speaker: {component: embedded_test::Speaker}\n"
                         "  echo: {component: embedded_test::Speaker}\n"));
  EXPECT_EQ((*robot)->apply().outcome, Outcome::Done);
  EXPECT_EQ((*robot)->host().tasks().size(), 2U);
  EXPECT_TRUE((*robot)->files().changes((*robot)->runtime().files()).empty());
}

TEST_F(EmbeddedRobotTest, ForwardsLogLinesOfUpdatePaths) {
  std::promise<std::string> said;
  bool heard = false;  // protected by the lock under which the sink is called
  set_log_sink([&](LogLevel, std::string_view source, std::string_view message) {
    if (source == "speaker" && !std::exchange(heard, true)) said.set_value(std::string(message));
  });
  auto robot = EmbeddedRobot::open(folder_ / "robot.yaml");
  ASSERT_TRUE(robot) << to_string(robot.error());
  ASSERT_EQ((*robot)->switch_to("talk").outcome, Outcome::Done);
  auto message = said.get_future();
  ASSERT_EQ(message.wait_for(std::chrono::seconds(20)), std::future_status::ready);
  EXPECT_EQ(message.get(), "I am updated");
  robot->reset();  // ends before the variables that the sink refers to
}

}  // namespace
}  // namespace segue::runtime

// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/base/log.hpp>
#include <segue/runtime/embedded_robot.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/task/component.hpp>
#include <segue/task_host/task_host.hpp>

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <future>
#include <optional>
#include <string>
#include <vector>

namespace embedded_test {

/// Logs on its update path.
class Speaker final : public segue::task::Component {
 public:
  Speaker() : Component({.activity = segue::periodic(std::chrono::milliseconds(1))}) {}

 private:
  void on_update() override { log(segue::LogLevel::Info, "I am updated"); }
};

/// Has a port, a property and an operation.
class Counter final : public segue::task::Component {
 public:
  Counter() : Component({.activity = segue::periodic(std::chrono::milliseconds(1))}) {}

 private:
  void on_update() override {
    int to = 0;
    if (in_.read(to) == segue::task::ReadStatus::NewData) count_ = to;
    if (*writes_) out_.write(count_);
  }

  segue::task::InputPort<int> in_{*this, "in"};
  segue::task::OutputPort<int> out_{*this, "out"};
  segue::task::Property<bool> writes_{*this, "writes", true, {.live = true}};
  segue::task::Operation<void(int)> set_{*this, "set", {"to"}, [this](int to) { count_ = to; }};
  int count_ = 1;
};

}  // namespace embedded_test

SEGUE_COMPONENT(embedded_test::Speaker)
SEGUE_COMPONENT(embedded_test::Counter)

namespace segue::runtime {
namespace {

using namespace std::chrono_literals;

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
  EXPECT_EQ(robot->switch_to("talk").outcome, Outcome::Done);
  ASSERT_EQ(robot->host().tasks().size(), 1U);
  EXPECT_EQ(robot->host().tasks().front().state, TaskState::Running);
  EXPECT_EQ(robot->shut_down().outcome, Outcome::Done);
}

TEST_F(EmbeddedRobotTest, ShuttingDownEndsStandby) {
  ASSERT_TRUE(write_file(folder_ / "sing.yaml",
                         "network: sing\ntasks:\n  singer: {component: embedded_test::Speaker}\n"));
  ASSERT_TRUE(write_file(folder_ / "robot.yaml", "robot: parrot\ncontrollers: [talk.yaml, sing.yaml]\n"));
  auto robot = EmbeddedRobot::open(folder_ / "robot.yaml");
  ASSERT_TRUE(robot) << to_string(robot.error());
  ASSERT_EQ(robot->switch_to("talk").outcome, Outcome::Done);
  const auto ready = robot->runtime().prepare({model::NetworkName("sing")}).get();
  ASSERT_TRUE(ready.at(0).ready) << ready.at(0).reason;
  EXPECT_EQ(robot->host().observe().tasks.size(), 2U);
  EXPECT_EQ(robot->shut_down().outcome, Outcome::Done);
  EXPECT_TRUE(robot->host().observe().empty());
}

TEST_F(EmbeddedRobotTest, AppliesItsFilesAsTheyAreNow) {
  auto robot = EmbeddedRobot::open(folder_ / "robot.yaml");
  ASSERT_TRUE(robot) << to_string(robot.error());
  ASSERT_EQ(robot->switch_to("talk").outcome, Outcome::Done);
  ASSERT_TRUE(write_file(folder_ / "talk.yaml", "network: talk\ntasks: 3\n"));
  const auto refused = robot->apply();
  EXPECT_EQ(refused.outcome, Outcome::Refused);
  EXPECT_NE(refused.error->diagnostics, nullptr) << refused.why();
  EXPECT_EQ(robot->files().changes(robot->runtime().files()).size(), 1U);
  ASSERT_TRUE(write_file(folder_ / "talk.yaml",
                         "network: talk\ntasks:\n  speaker: {component: embedded_test::Speaker}\n"
                         "  echo: {component: embedded_test::Speaker}\n"));
  EXPECT_EQ(robot->apply().outcome, Outcome::Done);
  EXPECT_EQ(robot->host().tasks().size(), 2U);
  EXPECT_TRUE(robot->files().changes(robot->runtime().files()).empty());
}

/// A robot that runs `count`.
class MembersOfTasks : public EmbeddedRobotTest {
 protected:
  void SetUp() override {
    EmbeddedRobotTest::SetUp();
    ASSERT_TRUE(write_file(folder_ / "talk.yaml",
                           "network: count\ntasks:\n  counter: {component: embedded_test::Counter}\n"));
    auto robot = EmbeddedRobot::open(folder_ / "robot.yaml");
    ASSERT_TRUE(robot) << to_string(robot.error());
    robot_.emplace(std::move(*robot));
    const auto switched = robot_->switch_to("count");
    ASSERT_TRUE(switched.ok()) << switched.why();
  }

  /// The sample comes, though others may come before it.
  void expect_sample(Port<int>& port, int expected) {
    for (int last = -1; last != expected;) {
      const auto sample = port.next(60s);
      ASSERT_TRUE(sample) << to_string(sample.error());
      last = *sample;
    }
  }

  std::optional<EmbeddedRobot> robot_;
};

TEST_F(MembersOfTasks, AreReadWrittenSetAndCalledByTheirAddress) {
  auto port = robot_->port<int>("counter.out");
  expect_sample(port, 1);
  ASSERT_TRUE(robot_->write("counter.in", 2));
  expect_sample(port, 2);
  ASSERT_TRUE(robot_->call("counter.set", type::Value::map({{"to", 3}})));
  expect_sample(port, 3);
  EXPECT_EQ(port.latest().value(), 3);
}

TEST_F(MembersOfTasks, HaveNoNextSampleWhereNoneIsWrittenInTime) {
  ASSERT_TRUE(robot_->set("counter.writes", false));
  EXPECT_EQ(robot_->runtime().events().back().message, "somebody set writes to false");
  EXPECT_EQ(robot_->port("counter.out").next(5ms).error().code, ErrorCode::DeadlineExceeded);
  EXPECT_EQ(robot_->port("counter.out").latest().error().code, ErrorCode::NotFound);
}

TEST_F(MembersOfTasks, AreNotFoundUnderAWrongAddress) {
  EXPECT_EQ(robot_->port("counter").next(60s).error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(robot_->port("counter.in").next(60s).error().code, ErrorCode::NotFound);
  EXPECT_FALSE(robot_->port<std::vector<int>>("counter.out").next(60s)) << "its samples are numbers";
  EXPECT_EQ(robot_->call("nobody.set").error().code, ErrorCode::NotFound);
}

TEST_F(MembersOfTasks, AreReadAgainWhereTheirTaskIsAnotherOne) {
  auto port = robot_->port<int>("counter.out");
  ASSERT_TRUE(robot_->runtime().switch_to(model::Network()).ok());
  while (port.next(60s)) {
  }
  ASSERT_TRUE(robot_->switch_to("count").ok());
  const auto sample = port.next(60s);
  EXPECT_TRUE(sample) << to_string(sample.error());
}

TEST_F(EmbeddedRobotTest, ForwardsLogLinesOfUpdatePaths) {
  std::promise<std::string> said;
  bool heard = false;  // protected by the lock under which the sink is called
  set_log_sink([&](LogLevel, std::string_view source, std::string_view message) {
    if (source == "speaker" && !std::exchange(heard, true)) said.set_value(std::string(message));
  });
  auto robot = EmbeddedRobot::open(folder_ / "robot.yaml");
  ASSERT_TRUE(robot) << to_string(robot.error());
  ASSERT_EQ(robot->switch_to("talk").outcome, Outcome::Done);
  auto message = said.get_future();
  ASSERT_EQ(message.wait_for(std::chrono::seconds(20)), std::future_status::ready);
  EXPECT_EQ(message.get(), "I am updated");
  robot = fail(ErrorCode::Cancelled, "the test ends");  // ends before the variables that the sink refers to
}

}  // namespace
}  // namespace segue::runtime

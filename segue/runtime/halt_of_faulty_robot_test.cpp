// SPDX-License-Identifier: Apache-2.0
// A robot that does not say what rest is, or does not come to rest, and tasks in error states: its devices
// are stopped all the same, and nothing is repaired for it.
#include <segue/runtime/test_support.hpp>
#include <segue/task/component.hpp>

#include <support/eventually.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string>

namespace faulty {

using namespace segue::task;

/// Fails as its property says.
class Part : public Component {
 public:
  Part() : Component({.activity = segue::periodic(std::chrono::milliseconds(1))}) {}

 protected:
  void on_update() override {
    if (*fault_ == "error") error("it is broken");
    if (*fault_ == "exception") exception("it is broken");
    if (*fault_ == "fatal") fatal("it is broken");
  }
  void on_error() override {}
  segue::Result<void> on_recover() override {
    return segue::fail(segue::ErrorCode::HookFailed, "it cannot be recovered");
  }

 private:
  Property<std::string> fault_{*this, "fault", "", {.live = true}};
};

class Wheels final : public Part {
 public:
  Wheels() : Part({.claims = {"wheels"}}) {}
};

}  // namespace faulty

SEGUE_COMPONENT(faulty::Part)
SEGUE_COMPONENT(faulty::Wheels)

namespace segue::runtime {
namespace {

using model::TaskId;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr const char* kDrive =
    "network: drive\n"
    "tasks:\n"
    "  wheels: {component: \"faulty::Wheels\", exclusive: [wheels]}\n"
    "  planner: {component: \"faulty::Part\"}\n"
    "  camera: {component: \"faulty::Part\"}\n";

class HaltOfFaultyRobot : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto switched = robot_.runtime.switch_to(testing::network_of(kDrive));
    ASSERT_EQ(switched.outcome, Outcome::Done) << testing::why(switched);
  }
  void break_down(const char* task, const char* fault, TaskState state) {
    const TimePoint deadline = RealClock::instance().now() + std::chrono::seconds(60);
    ASSERT_TRUE(robot_.host.set_property(TaskId(task), "fault", type::Value(fault), deadline));
    ASSERT_TRUE(segue::testing::eventually([&] { return believed(task) == state; }));
  }
  TaskState believed(const char* task) const {
    return robot_.runtime.belief().find_task(TaskId(task))->state;
  }
  TaskState state_of(const char* task) const { return robot_.host.observe().find_task(TaskId(task))->state; }

  testing::StandInRobot robot_;
};

TEST_F(HaltOfFaultyRobot, StopsDevicesAndLeavesABrokenTaskAlone) {
  break_down("planner", "error", TaskState::RunTimeError);
  break_down("camera", "exception", TaskState::Exception);
  const auto rest = robot_.runtime.halt({.who = "ann"}).get();
  EXPECT_TRUE(rest.at_rest) << rest.trouble;
  EXPECT_THAT(rest.stopped, ElementsAre(TaskId("wheels")));
  EXPECT_EQ(state_of("wheels"), TaskState::Stopped);
  EXPECT_EQ(state_of("planner"), TaskState::RunTimeError);
  EXPECT_EQ(state_of("camera"), TaskState::Exception);
}

TEST_F(HaltOfFaultyRobot, LeavesATaskInFatalAlone) {
  break_down("camera", "fatal", TaskState::Fatal);
  const auto rest = robot_.runtime.halt({.who = "ann"}).get();
  EXPECT_TRUE(rest.at_rest) << rest.trouble;
  EXPECT_EQ(state_of("wheels"), TaskState::Stopped);
  EXPECT_EQ(state_of("camera"), TaskState::Fatal);
}

TEST_F(HaltOfFaultyRobot, StopsADeviceThatIsInAnError) {
  break_down("wheels", "error", TaskState::RunTimeError);
  const auto rest = robot_.runtime.halt({.who = "ann"}).get();
  EXPECT_TRUE(rest.at_rest) << rest.trouble;
  EXPECT_THAT(rest.stopped, ElementsAre(TaskId("wheels")));
  EXPECT_EQ(state_of("wheels"), TaskState::Stopped);
}

TEST_F(HaltOfFaultyRobot, LeavesADeviceAloneWhoseHooksHaveStoppedItAlready) {
  break_down("wheels", "exception", TaskState::Exception);
  const auto rest = robot_.runtime.halt({.who = "ann"}).get();
  EXPECT_TRUE(rest.at_rest) << rest.trouble;
  EXPECT_THAT(rest.stopped, IsEmpty());
  EXPECT_EQ(state_of("wheels"), TaskState::Exception);
}

TEST(HaltThatFails, StopsDevicesBesideABrokenTask) {
  model::Halt halt;
  halt.controller = model::NetworkName("hold");
  halt.at_rest = {{model::TaskReaches{"wheels", "idle"}, {}}};
  halt.within = std::chrono::milliseconds(300);
  RuntimeOptions options;
  options.halt = std::move(halt);
  testing::StandInRobot robot(std::move(options));
  model::Network network = testing::network_of(kDrive);
  ASSERT_FALSE(robot.runtime.add_controller(network).has_errors());
  network.name = model::NetworkName("hold");
  ASSERT_FALSE(robot.runtime.add_controller(network).has_errors());
  ASSERT_EQ(robot.runtime.switch_to(model::NetworkName("drive")).outcome, Outcome::Done);
  const TimePoint deadline = RealClock::instance().now() + std::chrono::seconds(60);
  ASSERT_TRUE(robot.host.set_property(TaskId("camera"), "fault", type::Value("error"), deadline));
  ASSERT_TRUE(segue::testing::eventually(
      [&] { return robot.runtime.belief().find_task(TaskId("camera"))->state == TaskState::RunTimeError; }));
  const auto rest = robot.runtime.halt({.who = "ann"}).get();
  EXPECT_FALSE(rest.at_rest);
  EXPECT_THAT(rest.stopped, ElementsAre(TaskId("wheels"))) << rest.trouble;
}

}  // namespace
}  // namespace segue::runtime

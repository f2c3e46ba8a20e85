// SPDX-License-Identifier: Apache-2.0
// A robot that does not say what rest is, or does not come to rest, and tasks in error states: its devices
// are stopped all the same, and nothing is repaired for it.
#include <segue/runtime/test_support.hpp>
#include <segue/task/component.hpp>

#include <support/eventually.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <string>
#include <utility>

namespace faulty {

using namespace segue::task;

/// Fails as its property says.
class Part : public Component {
 public:
  explicit Part(std::vector<std::string> claims = {})
      : Component({.activity = segue::periodic(std::chrono::milliseconds(1)), .claims = std::move(claims)}) {}

 protected:
  void on_update() override {
    if (*fault_ == "error") error("it is broken");
    if (*fault_ == "exception") exception("it is broken");
    if (*fault_ == "fatal") fatal("it is broken");
  }
  void on_error() override {}
  segue::Result<void> on_recover() override {
    if (fault_->empty()) return {};
    return segue::fail(segue::ErrorCode::HookFailed, "it cannot be recovered");
  }

 private:
  Property<std::string> fault_{*this, "fault", "", {.live = true}};
};

class Wheels final : public Part {
 public:
  Wheels() : Part(std::vector<std::string>{"wheels"}) {}
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

/// Runs "drive", of which tasks break down.
struct FaultyRobot : testing::StandInRobot {
  explicit FaultyRobot(RuntimeOptions options = {}) : StandInRobot(std::move(options)) {
    add(kDrive, "drive");
    const auto switched = runtime.switch_to(model::NetworkName("drive"));
    EXPECT_EQ(switched.outcome, Outcome::Done) << switched.why();
  }
  void add(const std::string& text, const char* name) {
    model::Network network = testing::network_of(text);
    network.name = model::NetworkName(name);
    EXPECT_FALSE(runtime.add_controller(std::move(network)).has_errors());
  }
  void set_fault(const char* task, const char* fault) {
    EXPECT_TRUE(host.set_property(TaskId(task), "fault", type::Value(fault), in_a_minute()));
  }
  void break_down(const char* task, const char* fault, TaskState state) {
    set_fault(task, fault);
    EXPECT_TRUE(
        segue::testing::eventually([&] { return runtime.belief().find_task(TaskId(task))->state == state; }));
  }
  void recover(const char* task) {
    set_fault(task, "");
    const model::Action action{
        1, model::ActionKind::Recover, model::TaskAction{TaskId(task)}, model::Phase::Commit, {}};
    EXPECT_TRUE(host.perform(action, in_a_minute()));
  }
  TaskState state_of(const char* task) const { return host.observe().find_task(TaskId(task))->state; }
  static TimePoint in_a_minute() { return RealClock::instance().now() + std::chrono::minutes(1); }
};

TEST(HaltOfFaultyRobot, StopsDevicesAndLeavesABrokenTaskAlone) {
  FaultyRobot robot;
  robot.break_down("planner", "error", TaskState::RunTimeError);
  robot.break_down("camera", "exception", TaskState::Exception);
  const auto rest = robot.runtime.halt({.who = "ann"}).get();
  EXPECT_TRUE(rest.at_rest) << rest.trouble;
  EXPECT_THAT(rest.stopped, ElementsAre(TaskId("wheels")));
  EXPECT_EQ(robot.state_of("wheels"), TaskState::Stopped);
  EXPECT_EQ(robot.state_of("planner"), TaskState::RunTimeError);
  EXPECT_EQ(robot.state_of("camera"), TaskState::Exception);
}

TEST(HaltOfFaultyRobot, LeavesATaskInFatalAlone) {
  FaultyRobot robot;
  robot.break_down("camera", "fatal", TaskState::Fatal);
  const auto rest = robot.runtime.halt({.who = "ann"}).get();
  EXPECT_TRUE(rest.at_rest) << rest.trouble;
  EXPECT_EQ(robot.state_of("wheels"), TaskState::Stopped);
  EXPECT_EQ(robot.state_of("camera"), TaskState::Fatal);
}

TEST(HaltOfFaultyRobot, StopsADeviceThatIsInAnError) {
  FaultyRobot robot;
  robot.break_down("wheels", "error", TaskState::RunTimeError);
  const auto rest = robot.runtime.halt({.who = "ann"}).get();
  EXPECT_TRUE(rest.at_rest) << rest.trouble;
  EXPECT_THAT(rest.stopped, ElementsAre(TaskId("wheels")));
  EXPECT_EQ(robot.state_of("wheels"), TaskState::Stopped);
}

TEST(HaltOfFaultyRobot, LeavesADeviceAloneWhoseHooksHaveStoppedItAlready) {
  FaultyRobot robot;
  robot.break_down("wheels", "exception", TaskState::Exception);
  const auto rest = robot.runtime.halt({.who = "ann"}).get();
  EXPECT_TRUE(rest.at_rest) << rest.trouble;
  EXPECT_THAT(rest.stopped, IsEmpty());
  EXPECT_EQ(robot.state_of("wheels"), TaskState::Exception);
}

/// A transition is in progress when the device breaks down, the robot is halted, and the device recovers.
TEST(HaltOfFaultyRobot, StartsNoDeviceThatRecoversBeforeItIsPlanned) {
  FaultyRobot robot;
  robot.add(std::string(kDrive) + "  tool: {component: \"faulty::Part\"}\n", "work");
  std::shared_future<HaltResult> halt;
  robot.asking.ask([&](const model::Action&) -> Result<void> {
    if (halt.valid()) return {};
    robot.break_down("wheels", "exception", TaskState::Exception);
    halt = robot.runtime.halt({.who = "ann"});
    robot.recover("wheels");
    return {};
  });
  robot.runtime.request(model::NetworkName("work")).wait();
  robot.asking.ask({});
  ASSERT_TRUE(halt.valid());
  const auto rest = halt.get();
  EXPECT_TRUE(rest.at_rest) << rest.trouble;
  EXPECT_THAT(rest.stopped, IsEmpty());
  EXPECT_EQ(robot.state_of("wheels"), TaskState::PreOperational);
}

TEST(HaltThatFails, StopsDevicesBesideABrokenTask) {
  model::Halt halt;
  halt.controller = model::NetworkName("hold");
  halt.at_rest = {{model::TaskReaches{"wheels", "idle"}, {}}};
  halt.within = std::chrono::milliseconds(300);
  RuntimeOptions options;
  options.halt = std::move(halt);
  FaultyRobot robot(std::move(options));
  robot.add(kDrive, "hold");
  robot.break_down("camera", "error", TaskState::RunTimeError);
  const auto rest = robot.runtime.halt({.who = "ann"}).get();
  EXPECT_FALSE(rest.at_rest);
  EXPECT_THAT(rest.stopped, ElementsAre(TaskId("wheels"))) << rest.trouble;
}

}  // namespace
}  // namespace segue::runtime

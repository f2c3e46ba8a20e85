// SPDX-License-Identifier: Apache-2.0
// A component learns of an input that goes without samples; on a virtual clock.
#include <segue/base/virtual_clock.hpp>
#include <segue/sample_link/local.hpp>
#include <segue/task/component.hpp>
#include <segue/task/input_timeout.hpp>
#include <segue/task/manual_executor.hpp>
#include <segue/task/task.hpp>

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

namespace segue::sample_link {
namespace {

using namespace std::chrono_literals;
using std::chrono::milliseconds;

TimePoint in_a_minute() {
  return RealClock::instance().now() + 60s;
}

/// Notes at each update whether commands are overdue.
class Wheels final : public task::Component {
 public:
  Wheels() : Component({.trigger_on = {"measured"}}) {}

  task::InputPort<double> measured{*this, "measured"};
  task::InputPort<double> command{*this, "command"};
  task::InputTimeout timeout{command, "timeout", 200ms};
  std::vector<bool> overdue;  ///< of each update
  Duration age{-1};           ///< in the last one
  bool fails = false;

 protected:
  void on_update() override {
    measured.drain();
    command.drain();
    overdue.push_back(timeout.passed());
    age = timeout.age();
    if (fails) error(hot_, "too hot");
  }
  void on_error() override {
    if (!fails) recovered();
  }

 private:
  task::ErrorState hot_{*this, "HOT"};
};

class Numbers final : public task::Component {
 public:
  task::OutputPort<double> out{*this, "out"};
};

class InputTimeoutTest : public ::testing::Test {
 protected:
  explicit InputTimeoutTest(const Activity& activity = {.trigger = Trigger::PortDriven}) {
    auto made = std::make_unique<Wheels>();
    wheels = made.get();
    task = std::move(task::Task::create("wheels", std::move(made), activity, executor).value());
    EXPECT_TRUE(connect(commander.out, wheels->command, {}));
    EXPECT_TRUE(connect(sensor.out, wheels->measured, {}));
    EXPECT_TRUE(task->configure(in_a_minute()));
    EXPECT_TRUE(task->start(in_a_minute()));
    executor->run_ready();
  }
  ~InputTimeoutTest() override { task.reset(); }

  void set_timeout(milliseconds limit) {
    type::ValueMap values;
    values.append("timeout", limit.count());
    const auto set = task->set_properties(type::Value(std::move(values)), in_a_minute());
    ASSERT_TRUE(set) << to_string(set.error());
  }
  void measure() {
    sensor.out.write(1);
    executor->run_ready();
  }

  VirtualClock clock;
  std::shared_ptr<task::ManualExecutor> executor = std::make_shared<task::ManualExecutor>(clock);
  Numbers commander;
  Numbers sensor;
  std::unique_ptr<task::Task> task;
  Wheels* wheels = nullptr;
};

using Answers = std::vector<bool>;

class PeriodicTimeout : public InputTimeoutTest {
 protected:
  PeriodicTimeout() : InputTimeoutTest({.trigger = Trigger::Periodic, .period = 100ms}) {}
};

TEST_F(PeriodicTimeout, IsCountedFromTheStart) {
  executor->advance(300ms);
  EXPECT_EQ(wheels->overdue, (Answers{false, false, true, true}));
}

TEST_F(PeriodicTimeout, IsCountedAnewFromEachSample) {
  executor->advance(250ms);
  commander.out.write(1);
  wheels->overdue.clear();
  executor->advance(300ms);  // the sample is read at 300 ms
  EXPECT_EQ(wheels->overdue, (Answers{false, false, true}));
}

TEST_F(PeriodicTimeout, AgeIsThatOfTheLastSample) {
  executor->advance(250ms);
  commander.out.write(1);
  executor->advance(50ms);
  EXPECT_EQ(wheels->age, 0ms);
  executor->advance(500ms);
  EXPECT_EQ(wheels->age, 500ms);
}

TEST_F(PeriodicTimeout, IsCountedAnewFromEachStart) {
  executor->advance(300ms);
  ASSERT_TRUE(task->stop(in_a_minute()));
  executor->advance(1s);
  wheels->overdue.clear();
  ASSERT_TRUE(task->start(in_a_minute()));
  executor->run_ready();
  EXPECT_EQ(wheels->overdue, (Answers{false}));
}

TEST_F(PeriodicTimeout, IsALiveProperty) {
  executor->advance(100ms);
  set_timeout(1h);
  executor->advance(1s);
  EXPECT_FALSE(wheels->overdue.back());
  set_timeout(100ms);
  executor->advance(100ms);
  EXPECT_TRUE(wheels->overdue.back());
}

TEST_F(PeriodicTimeout, OfZeroNeverPasses) {
  set_timeout(0ms);
  executor->advance(1h);
  EXPECT_FALSE(wheels->overdue.back());
}

TEST_F(InputTimeoutTest, WakesATaskThatIsDrivenBySamplesOnce) {
  executor->advance(199ms);
  EXPECT_EQ(wheels->overdue, Answers{});
  executor->advance(1ms);
  EXPECT_EQ(wheels->overdue, (Answers{true}));
  executor->advance(10s);
  EXPECT_EQ(wheels->overdue, (Answers{true}));
}

TEST_F(InputTimeoutTest, WakesAgainAfterTheNextSample) {
  executor->advance(300ms);
  commander.out.write(1);
  measure();
  executor->advance(200ms);
  EXPECT_EQ(wheels->overdue, (Answers{true, false, true}));
}

TEST_F(InputTimeoutTest, DoesNotPassWhileSamplesCome) {
  for (int i = 0; i < 10; ++i) {
    executor->advance(150ms);
    commander.out.write(i);
    measure();
  }
  EXPECT_EQ(wheels->overdue, Answers(10, false));
}

TEST_F(InputTimeoutTest, NeedNotWakeATaskThatHasSeenItPass) {
  clock.advance(300ms);
  measure();
  executor->advance(1s);
  EXPECT_EQ(wheels->overdue, (Answers{true}));
}

TEST_F(InputTimeoutTest, WakesAtOnceWhereItIsSetToLessThanHasPassed) {
  executor->advance(150ms);
  set_timeout(100ms);
  executor->run_ready();
  EXPECT_EQ(wheels->overdue, (Answers{true}));
}

TEST_F(InputTimeoutTest, MayBeAsLongAsTimeCanBeCounted) {
  ASSERT_TRUE(task->stop(in_a_minute()));
  clock.advance(48h);
  ASSERT_TRUE(task->start(in_a_minute()));
  set_timeout(milliseconds::max());
  executor->advance(1s);
  EXPECT_EQ(wheels->overdue, Answers{});
}

TEST_F(InputTimeoutTest, DoesNotWakeAStoppedTask) {
  ASSERT_TRUE(task->stop(in_a_minute()));
  executor->advance(1s);
  EXPECT_EQ(wheels->overdue, Answers{});
}

TEST_F(InputTimeoutTest, ThatPassesDuringAnErrorIsSeenAfterIt) {
  wheels->fails = true;
  measure();
  ASSERT_EQ(task->state(), TaskState::RunTimeError);
  executor->advance(1s);
  wheels->fails = false;
  ASSERT_TRUE(task->recover(in_a_minute()));
  executor->run_ready();
  EXPECT_EQ(wheels->overdue, (Answers{false, true}));
}

}  // namespace
}  // namespace segue::sample_link

// SPDX-License-Identifier: Apache-2.0
// An action that has lost commands nothing any more, whatever it was doing when it was preempted.
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/mission_engine/engine_test_support.hpp>
#include <segue/mission_robot/controller_runner.hpp>
#include <segue/mission_robot/fake_commanded_robot.hpp>
#include <segue/mission_robot/pool_runner.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "support/eventually.hpp"
#include "support/forwarding_commanded_robot.hpp"

namespace segue::mission {
namespace {

using namespace std::chrono_literals;
using ::testing::Contains;
using ::testing::IsEmpty;
using type::Value;

/// Holds the question of one number until it is let go. Commands are answered, too, where whoever asks waits
/// no longer, as a real robot does.
class HeldRobot final : public testing::ForwardingCommandedRobot {
 public:
  explicit HeldRobot(std::size_t held)
      : ForwardingCommandedRobot(std::make_shared<FakeCommandedRobot>()), held_(held) {}

  Result<void> request(const ControllerRequest& what, const Wait& wait) override {
    if (!command("request", wait)) return no_longer_wanted();
    return inner_->request(what, wait);
  }
  Result<ControllerTrouble> trouble(std::string_view controller, const Wait& wait) override {
    question("trouble", wait.stop);
    if (wait.is_stopped()) return no_longer_wanted();
    return inner_->trouble(controller, wait);
  }
  Result<ControllerConflicts> conflicts(const Wait& wait) override {
    question("conflicts", wait.stop);
    return inner_->conflicts(wait);
  }
  void take_instance(const model::InstanceQuestion& /*what*/, const Wait& /*wait*/,
                     model::InstanceAnswer answered) override {
    answer_later("take_instance", [answered = std::move(answered)] {
      answered(model::TakenInstance{"planner_1", 1});
    });
  }
  Result<Value> call(const Member& operation, const Value& arguments, const Wait& wait) override {
    if (!command("call", wait)) return no_longer_wanted();
    return inner_->call(operation, arguments, wait);
  }
  Result<void> set(const Member& property, const Value& value, const Wait& wait) override {
    if (!command("set", wait)) return no_longer_wanted();
    return inner_->set(property, value, wait);
  }
  Result<void> write(const Member& port, const Value& value, const Wait& wait) override {
    if (!command("write", wait)) return no_longer_wanted();
    return inner_->write(port, value, wait);
  }
  void watch(const TaskQuestion& asked, const Wait& wait, TaskAnswer answered) override {
    answer_later("watch", [this, asked, wait, answered = std::move(answered)] {
      inner_->watch(asked, wait, answered);
    });
  }
  Result<std::unique_ptr<PortSamples>> open(const Member& port, const Wait& wait) override {
    question("open", wait.stop);
    if (wait.is_stopped()) return no_longer_wanted();
    return inner_->open(port, wait);
  }

  /// The question with the number at which the robot is held.
  std::string wait_for_question() {
    Lock lock(mutex_);
    EXPECT_TRUE(changed_.wait_for(mutex_, {}, 60s, [this] { return questions_.size() >= held_; }));
    return questions_.size() < held_ ? "" : questions_[held_ - 1];
  }
  /// From now on nothing may be commanded.
  void forbid() {
    const Lock lock(mutex_);
    forbidden_ = true;
  }
  void let_go() {
    std::function<void()> ask;
    {
      const Lock lock(mutex_);
      let_go_ = true;
      changed_.notify_all();
      ask = std::exchange(unanswered_, nullptr);
    }
    if (ask) ask();
  }
  std::vector<std::string> commanded_after_loss() {
    const Lock lock(mutex_);
    return commanded_after_loss_;
  }

 private:
  void question(const char* what, const std::stop_token& stop) {
    Lock lock(mutex_);
    questions_.emplace_back(what);
    changed_.notify_all();
    if (questions_.size() != held_) return;
    EXPECT_TRUE(changed_.wait_for(mutex_, stop, 60s, [this] { return let_go_; }) || stop.stop_requested());
  }
  /// The question that is held gets its answer later; whoever asks does not wait here.
  void answer_later(const char* what, std::function<void()> ask) {
    {
      const Lock lock(mutex_);
      questions_.emplace_back(what);
      changed_.notify_all();
      if (questions_.size() == held_ && !let_go_) {
        unanswered_ = std::move(ask);
        return;
      }
    }
    ask();
  }
  bool command(const char* what, const Wait& wait) {
    {
      const Lock lock(mutex_);
      if (forbidden_ && !wait.is_stopped()) commanded_after_loss_.emplace_back(what);
    }
    question(what, wait.stop);
    return !wait.is_stopped();
  }

  const std::size_t held_;
  Mutex mutex_;  ///< protects all below
  StoppableConditionVariable changed_;
  std::vector<std::string> questions_;
  std::vector<std::string> commanded_after_loss_;
  bool forbidden_ = false;
  bool let_go_ = false;
  std::function<void()> unanswered_;  ///< asks the question that is held
};

class PreemptedActions : public RunningMission {
 protected:
  void begin(std::size_t held, const std::string& action) {
    robot_ = std::make_shared<HeldRobot>(held);
    ControllerOptions options;
    options.period = 1ms;
    Runners runners;
    runners.set_controllers(std::make_shared<ControllerRunner>(robot_, options));
    runners.set_pools(std::make_shared<PoolRunner>(robot_, PoolOptions{1ms, 60s}));
    begin_mission("mission: m\nactions:\n  go: {" + action + "}\naction: go\n", runners);
  }
  /// Returns once the engine has preempted its actions: it hears what it is asked later after that.
  void preempt() {
    engine_->stop();
    for (int i = 0; i < 2; ++i) {
      const auto heard = std::make_shared<std::atomic<bool>>(false);
      engine_->post([heard] { *heard = true; });
      EXPECT_TRUE(testing::eventually([&] { return *heard || is_over_; }));
    }
  }
  /// Preempts the action at that question, which is returned; the action must have commanded nothing since.
  std::string preempt_at_question(std::size_t number, const std::string& action) {
    SCOPED_TRACE("question " + std::to_string(number));
    begin(number, action);
    const std::string question = robot_->wait_for_question();
    preempt();
    robot_->forbid();
    robot_->let_go();
    EXPECT_EQ(ended().outcome_name, "preempted");
    EXPECT_THAT(robot_->commanded_after_loss(), IsEmpty()) << "it was held at " << question;
    return question;
  }

  std::shared_ptr<HeldRobot> robot_;
};

constexpr const char* kEverything =
    "outputs: {pose: any}, run: {controller: go_home, call: {planner.reset: {}, planner.set_goal: {goal: "
    "x}}, "
    "write: {planner.goal: x}, until: [{call: planner.failed, is: true}, {task: planner, state: arrived}, "
    "{port: planner.status, where: 'value == 1'}], outputs: {pose: odometry.pose}}";

TEST_F(PreemptedActions, CommandNothingWhicheverQuestionTheyWereAt) {
  std::vector<std::string> questions;
  for (std::size_t number = 1; number <= 14; ++number)
    questions.push_back(preempt_at_question(number, kEverything));
  for (const char* each : {"conflicts", "request", "call", "write", "watch", "open", "trouble"})
    EXPECT_THAT(questions, Contains(each)) << "otherwise the test has not tried it";
}

TEST_F(PreemptedActions, EndWhicheverQuestionTheRobotLeavesUnanswered) {
  std::vector<std::string> questions;
  for (std::size_t number = 1; number <= 14; ++number) {
    SCOPED_TRACE("question " + std::to_string(number));
    begin(number, kEverything);
    questions.push_back(robot_->wait_for_question());
    engine_->stop();
    EXPECT_EQ(ended().outcome_name, "preempted") << "it was held at " << questions.back();
  }
  for (const char* each : {"conflicts", "request", "call", "write", "watch", "open", "trouble"})
    EXPECT_THAT(questions, Contains(each)) << "otherwise the test has not tried it";
}

TEST_F(PreemptedActions, EndWhileTheyWaitForAnInstanceOfAPool) {
  begin(1, "pure: true, run: {pool: planner, call: {plan: {}}}");
  EXPECT_EQ(robot_->wait_for_question(), "take_instance");
  engine_->stop();
  EXPECT_EQ(ended().outcome_name, "preempted");
}

TEST_F(PreemptedActions, EndWhileTheRobotStillStartsTheirController) {
  begin(2, kEverything);
  EXPECT_EQ(robot_->wait_for_question(), "request");
  engine_->stop();
  EXPECT_EQ(ended().outcome_name, "preempted");
}

TEST_F(PreemptedActions, EndWhileAnInstanceOfAPoolStillWorks) {
  begin(2, "pure: true, run: {pool: planner, call: {plan: {}}}");
  EXPECT_EQ(robot_->wait_for_question(), "call");
  engine_->stop();
  EXPECT_EQ(ended().outcome_name, "preempted");
}

bool handles_preemption(const std::string& after_work) {
  Diagnostics diagnostics;
  auto mission =
      read_mission("mission: m\nactions: {wait: {}}\nstart: work\nstates:\n  work: {action: wait, on: {" +
                       after_work + "}}\n  back: {action: wait, on: {success: return success}}\n",
                   "m.yaml", diagnostics);
  EXPECT_TRUE(mission) << to_string(diagnostics);
  const auto program = Program::compile(std::move(*mission));
  EXPECT_TRUE(program) << to_string(program.error());
  return (*program)->handles_preemption();
}

TEST(Preemption, IsHandledWhereAStateFollowsIt) {
  EXPECT_TRUE(handles_preemption("success: back, preempted: back"));
  EXPECT_FALSE(handles_preemption("success: back"));
  EXPECT_FALSE(handles_preemption("success: back, preempted: return success")) << "nothing is done then";
}

}  // namespace
}  // namespace segue::mission

// SPDX-License-Identifier: Apache-2.0
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission_engine/engine_test_support.hpp>
#include <segue/mission_robot/pool_runner.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

namespace segue::mission {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using type::Value;

/// Has a pool of two planners; a function of the test answers.
class PlanningRobot final : public CommandedRobot {
 public:
  using Answer = std::function<Result<Value>(const std::string& instance, const Value& arguments)>;

  explicit PlanningRobot(Answer answer) : answer_(std::move(answer)) {}

  Result<void> request(const ControllerRequest& /*what*/, const Wait& /*wait*/) override { return {}; }
  Result<ControllerTrouble> trouble(std::string_view /*controller*/, const Wait& /*wait*/) override {
    return ControllerTrouble{};
  }
  Result<ControllerConflicts> conflicts(const Wait& /*wait*/) override { return ControllerConflicts{}; }
  Result<void> prepare(const std::vector<std::string>& /*names*/, const Wait& /*wait*/) override {
    return {};
  }
  Result<std::vector<PoolView>> pools(const Wait& /*wait*/) override {
    const Lock lock(mutex_);
    if (is_gone_) return gone();
    return std::vector{PoolView{"planner", {instances_.begin(), instances_.end()}, 2}};
  }
  /// Rather another one than the one that was lost; nobody is answered before there is one.
  void take_instance(const model::InstanceQuestion& what, const Wait& /*wait*/,
                     model::InstanceAnswer answered) override {
    const Lock lock(mutex_);
    if (is_gone_) return answered(gone());
    const PoolInstanceView* best = nullptr;
    for (const PoolInstanceView& one : instances_) {
      if (one.ready && (best == nullptr || best->task == what.lost.task)) best = &one;
    }
    if (best != nullptr) return answered(model::TakenInstance{best->task, best->pid});
    if (std::ranges::all_of(instances_, &PoolInstanceView::given_up))
      return answered(fail(ErrorCode::Unavailable, "no instance of pool 'planner' is ready"));
    ++waiting_;
    waits_.notify_all();
  }
  Result<Value> call(const Member& operation, const Value& arguments, const Wait& /*wait*/) override {
    {
      const Lock lock(mutex_);
      called_.push_back(operation.task);
    }
    return answer_(operation.task, arguments);
  }
  Result<void> set(const Member& /*property*/, const Value& /*value*/, const Wait& /*wait*/) override {
    return {};
  }
  Result<void> write(const Member& /*port*/, const Value& /*value*/, const Wait& /*wait*/) override {
    return {};
  }
  void watch(const TaskQuestion& /*question*/, const Wait& /*wait*/, TaskAnswer answered) override {
    answered(TaskView{});
  }
  void changes(std::uint64_t seen, const Wait& /*wait*/, ChangesAnswer answered) override {
    if (seen == 0) answered(1);
  }
  Result<std::unique_ptr<PortSamples>> open(const Member& port, const Wait& /*wait*/) override {
    return fail(ErrorCode::NotFound, to_string(port));
  }

  void lose(const std::string& instance, bool for_good = false) {
    change(instance, [&](PoolInstanceView& one) {
      one.ready = false;
      one.given_up = for_good;
      one.reason = "its process is gone";
    });
  }
  void start_again(const std::string& instance) {
    change(instance, [](PoolInstanceView& one) { one = {one.task, one.pid + 100, true, false, ""}; });
  }
  /// Nobody has needed it.
  void leave(const std::string& instance) {
    const Lock lock(mutex_);
    std::erase_if(instances_, [&](const PoolInstanceView& one) { return one.task == instance; });
  }
  void vanish() {
    const Lock lock(mutex_);
    is_gone_ = true;
  }
  void wait_until_somebody_waits() {
    Lock lock(mutex_);
    EXPECT_TRUE(waits_.wait_for(mutex_, 60s, [&] { return waiting_ > 0; }));
  }
  std::vector<std::string> called() {
    const Lock lock(mutex_);
    return called_;
  }

 private:
  static Error gone() { return fail(ErrorCode::Unavailable, "the test took the robot away"); }
  void change(const std::string& instance, const std::function<void(PoolInstanceView&)>& how) {
    const Lock lock(mutex_);
    for (PoolInstanceView& one : instances_) {
      if (one.task == instance) how(one);
    }
  }

  const Answer answer_;
  Mutex mutex_;  ///< protects all below
  std::vector<PoolInstanceView> instances_{{"planner_1", 1, true}, {"planner_2", 2, true}};
  ConditionVariable waits_;
  std::vector<std::string> called_;
  int waiting_ = 0;
  bool is_gone_ = false;
};

Value route(const char* outcome) {
  return Value::map({{"outcome", outcome}, {"path", Value::map({{"length", 7}})}});
}
Error connection_broke() {
  return fail(ErrorCode::Unavailable, "the connection is closed");
}

class PoolCalls : public RunningMission {
 protected:
  /// A mission of one action with these declarations.
  void begin(PlanningRobot::Answer answer, const std::string& declared = "pure: true") {
    robot_ = std::make_shared<PlanningRobot>(std::move(answer));
    const std::string text =
        "mission: m\n"
        "actions:\n"
        "  plan:\n"
        "    inputs: {to: {type: text, default: home}}\n"
        "    outputs: {length: any, all: any}\n"
        "    outcomes: [found, no_route]\n"
        "    " +
        declared +
        "\n"
        "    run: {pool: planner, call: {plan: {to: '{to}'}}, outcome_from: outcome,\n"
        "          outputs: {length: path.length, all: value}}\n"
        "outcomes: [found, no_route]\n"
        "outputs: {length: any}\n"
        "start: plan\n"
        "flows: [plan.length -> outputs.length]\n"
        "states: {plan: {on: {found: return found, no_route: return no_route}}}\n";
    Runners runners;
    runners.set_pools(std::make_shared<PoolRunner>(robot_, options_));
    begin_mission(text, runners);
  }

  std::shared_ptr<PlanningRobot> robot_;
  PoolOptions options_{.period = 1ms, .notice = 60s};
};

TEST_F(PoolCalls, EndAsTheAnswerSays) {
  begin([](const std::string&, const Value& arguments) {
    EXPECT_EQ(arguments, Value::map({{"to", "home"}}));
    return route("found");
  });
  EXPECT_EQ(ended().outcome_name, "found");
  EXPECT_EQ(engine_->result().outputs[0], Value(7));
  begin([](const std::string&, const Value&) { return route("no_route"); });
  EXPECT_EQ(ended().outcome_name, "no_route");
}

TEST_F(PoolCalls, SayWhichTimeLimitHasPassed) {
  begin([](const std::string&, const Value&) -> Result<Value> {
    return fail(ErrorCode::DeadlineExceeded, "operation 'plan' did not begin in time");
  });
  EXPECT_EQ(ended().outcome_name, "aborted");
  EXPECT_THAT(engine_->result().error,
              HasSubstr("planner_1.plan has not answered within the action's "
                        "'timeout' of 60s (operation 'plan' did not begin in time)"));
}

TEST_F(PoolCalls, AbortWithTheErrorOfTheOperation) {
  begin([](const std::string&, const Value&) -> Result<Value> {
    return fail(ErrorCode::InvalidArgument, "the goal is outside of the map");
  });
  EXPECT_EQ(ended().outcome_name, "aborted");
  EXPECT_THAT(engine_->result().error, HasSubstr("the goal is outside of the map"));
  EXPECT_THAT(robot_->called(), ElementsAre("planner_1"));
}

TEST_F(PoolCalls, AbortWhereTheAnswerIsNotAsExpected) {
  begin([](const std::string&, const Value&) { return route("perhaps"); });
  EXPECT_EQ(ended().outcome_name, "aborted");
  EXPECT_THAT(engine_->result().error, HasSubstr("'perhaps' as 'outcome', which is none of its outcomes"));
  begin([](const std::string&, const Value&) { return Value::map({{"outcome", "found"}}); });
  EXPECT_EQ(ended().outcome_name, "aborted");
  EXPECT_THAT(engine_->result().error, HasSubstr("has no field 'path.length'"));
}

TEST_F(PoolCalls, AreRepeatedByAnotherInstanceWhereOneIsLost) {
  begin([this](const std::string& instance, const Value&) -> Result<Value> {
    if (instance == "planner_2") return route("found");
    robot_->lose(instance);
    return connection_broke();
  });
  EXPECT_EQ(ended().outcome_name, "found");
  EXPECT_THAT(robot_->called(), ElementsAre("planner_1", "planner_2"));
}

TEST_F(PoolCalls, WaitUntilAnInstanceIsThereAgain) {
  int calls = 0;
  begin([this, &calls](const std::string& instance, const Value&) -> Result<Value> {
    if (++calls == 3) return route("found");
    robot_->lose(instance);
    if (calls == 2) robot_->start_again("planner_1");
    return connection_broke();
  });
  EXPECT_EQ(ended().outcome_name, "found");
  EXPECT_THAT(robot_->called(), ElementsAre("planner_1", "planner_2", "planner_1"));
}

TEST_F(PoolCalls, AreRepeatedABoundedNumberOfTimes) {
  begin([this](const std::string& instance, const Value&) -> Result<Value> {
    robot_->lose(instance);
    robot_->start_again(instance);
    return connection_broke();
  });
  EXPECT_EQ(ended().outcome_name, "aborted");
  EXPECT_THAT(engine_->result().error, HasSubstr("3 attempts have failed"));
  EXPECT_THAT(robot_->called(), ElementsAre("planner_1", "planner_2", "planner_1"))
      << "not by the same one, though it is there again";
}

TEST_F(PoolCalls, AreRepeatedAsOftenWhereThePoolHasFewerInstancesAtTheMoment) {
  int calls = 0;
  begin([this, &calls](const std::string& instance, const Value&) -> Result<Value> {
    if (++calls == 3) return route("found");
    robot_->lose(instance);
    if (calls == 1)
      robot_->leave(instance);
    else
      robot_->start_again(instance);
    return connection_broke();
  });
  EXPECT_EQ(ended().outcome_name, "found") << engine_->result().error;
  EXPECT_THAT(robot_->called(), ElementsAre("planner_1", "planner_2", "planner_2"));
}

TEST_F(PoolCalls, AreNotRepeatedUnlessTheActionIsPure) {
  begin(
      [this](const std::string& instance, const Value&) -> Result<Value> {
        robot_->lose(instance);
        return connection_broke();
      },
      "strict: true");
  EXPECT_EQ(ended().outcome_name, "aborted");
  EXPECT_THAT(engine_->result().error, HasSubstr("planner_1 was lost while it worked"));
  EXPECT_THAT(robot_->called(), ElementsAre("planner_1"));
}

TEST_F(PoolCalls, AbortAtOnceWhereNoInstanceComesBack) {
  begin([this](const std::string&, const Value&) -> Result<Value> {
    robot_->lose("planner_1", true);
    robot_->lose("planner_2", true);
    return connection_broke();
  });
  EXPECT_EQ(ended().outcome_name, "aborted");
  EXPECT_THAT(engine_->result().error, HasSubstr("no instance of pool 'planner' is ready"));
}

TEST_F(PoolCalls, EndAsPreemptedWhereTheRobotIsGone) {
  options_.unreachable = [this](const Error&) { engine_->stop(); };
  for (const char* declared : {"pure: true", "strict: true"}) {
    begin(
        [this](const std::string&, const Value&) -> Result<Value> {
          robot_->vanish();
          return connection_broke();
        },
        declared);
    EXPECT_EQ(ended().outcome_name, "preempted") << engine_->result().error;
  }
}

TEST_F(PoolCalls, AreRepeatedWhereTheInstanceIsBeingStoppedWhateverTheActionIs) {
  begin(
      [this](const std::string& instance, const Value&) -> Result<Value> {
        if (instance == "planner_2") return route("found");
        robot_->lose(instance);
        return fail(ErrorCode::InvalidState, "planner_1 is being stopped");
      },
      "strict: true");
  EXPECT_EQ(ended().outcome_name, "found") << engine_->result().error;
  EXPECT_THAT(robot_->called(), ElementsAre("planner_1", "planner_2"));
}

TEST_F(PoolCalls, EndAtOnceWhereTheyArePreemptedWhileTheyWaitForAnInstance) {
  robot_ = std::make_shared<PlanningRobot>([](const std::string&, const Value&) { return route("found"); });
  robot_->lose("planner_1");
  robot_->lose("planner_2");
  Runners runners;
  runners.set_pools(std::make_shared<PoolRunner>(robot_, options_));
  runners.add("wait", [this](ActionCall& /*call*/) -> Ending {
    robot_->wait_until_somebody_waits();
    return {};
  });
  begin_mission(
      "mission: m\n"
      "actions:\n"
      "  plan: {pure: true, run: {pool: planner, call: {plan: {}}}}\n"
      "  other: {run: {callback: wait}}\n"
      "start: race\n"
      "states:\n"
      "  race:\n"
      "    kind: preemptive\n"
      "    on: {success: return success}\n"
      "    states:\n"
      "      plan: {on: {success: return success}}\n"
      "      other: {on: {success: return success}}\n",
      runners);
  EXPECT_EQ(ended().outcome_name, "success") << engine_->result().error;
  EXPECT_TRUE(robot_->called().empty());
}

}  // namespace
}  // namespace segue::mission

// SPDX-License-Identifier: Apache-2.0
#include <segue/robot/served_robot.hpp>

#include <gtest/gtest.h>

namespace segue::robot {
namespace {

using type::Value;

/// Answers what it is told to.
class FakeService final : public control::RobotService {
 public:
  Value status_answer = Value::map({{"controller", "explore"}, {"unresolved", Value::List{}}});
  Value switch_answer = Value::map({{"outcome", "done"}});
  Value task_answer;
  std::string requested;
  std::string who;

  Result<Value> status() override { return status_answer; }
  Result<Value> task(std::string_view /*id*/) override { return task_answer; }
  Result<Value> switch_to(std::string_view controller, const control::SwitchOptions& options,
                          TimePoint /*deadline*/) override {
    requested = controller;
    who = options.who;
    return switch_answer;
  }
  Result<Value> switch_to_network(std::string_view /*text*/, std::string_view /*file*/,
                                  const control::SwitchOptions& /*options*/,
                                  TimePoint /*deadline*/) override {
    return no();
  }
  Result<Value> plan(std::string_view /*controller*/, const control::SwitchOptions& /*options*/,
                     TimePoint /*deadline*/) override {
    return no();
  }
  Result<Value> apply(const control::SwitchOptions& /*options*/, TimePoint /*deadline*/) override {
    return no();
  }
  Result<Value> prepare(const std::vector<std::string>& /*controllers*/, TimePoint /*deadline*/) override {
    return no();
  }
  Result<Value> apply_transition(std::string_view /*text*/, std::string_view /*file*/,
                                 TimePoint /*deadline*/) override {
    return no();
  }
  Result<void> reset_belief() override { return no(); }
  Result<void> set_property(std::string_view /*task*/, std::string_view /*property*/, const Value& /*value*/,
                            TimePoint /*deadline*/) override {
    return no();
  }
  Result<Value> call(std::string_view /*task*/, std::string_view /*operation*/, const Value& /*arguments*/,
                     TimePoint /*deadline*/) override {
    return no();
  }
  Result<std::unique_ptr<control::SampleStream>> open_port(std::string_view /*task*/,
                                                           std::string_view /*port*/,
                                                           std::size_t /*buffer*/) override {
    return no();
  }
  Result<Value> events(std::uint64_t /*after*/, Duration /*wait*/) override { return no(); }
  Result<Value> history() override { return no(); }
  Result<void> shut_down() override { return no(); }

 private:
  static Error no() { return fail(ErrorCode::Unsupported, "not in this test"); }
};

class ServedRobotTest : public ::testing::Test {
 protected:
  FakeService service_;
  ServedRobot robot_{service_, "a test"};
};

TEST_F(ServedRobotTest, RequestsInTheNameOfItsUser) {
  EXPECT_TRUE(robot_.request("explore", {}));
  EXPECT_EQ(service_.requested, "explore");
  EXPECT_EQ(service_.who, "a test");
}

TEST_F(ServedRobotTest, ReportsWhyAControllerDoesNotRun) {
  service_.switch_answer = Value::map({{"outcome", "refused"}, {"error", "no such controller"}});
  const auto refused = robot_.request("explore", {});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "the request for controller 'explore' was refused: no such controller");
  service_.switch_answer = Value::map({{"outcome", "superseded"}});
  EXPECT_EQ(robot_.request("", {}).error().code, ErrorCode::Superseded);
}

TEST_F(ServedRobotTest, SeesWhetherAControllerRunsAsItShould) {
  EXPECT_EQ(*robot_.trouble("explore"), "");
  EXPECT_EQ(*robot_.trouble("drive"), "the robot runs controller 'explore'");
  service_.status_answer = Value::map({{"controller", ""}});
  EXPECT_EQ(*robot_.trouble("drive"), "the robot runs the empty network");
  service_.status_answer =
      Value::map({{"controller", "drive"}, {"unresolved", Value::list({"task 'a' failed still"})}});
  EXPECT_EQ(*robot_.trouble("drive"), "task 'a' failed still");
}

TEST_F(ServedRobotTest, SeesTasks) {
  service_.task_answer =
      Value::map({{"state", "running"}, {"state_name", "arrived"}, {"cycles", std::uint64_t{7}}});
  const auto task = robot_.task("planner");
  ASSERT_TRUE(task);
  EXPECT_EQ(task->state, "running");
  EXPECT_EQ(task->state_name, "arrived");
  EXPECT_EQ(task->updates, 7U);
}

}  // namespace
}  // namespace segue::robot

// SPDX-License-Identifier: Apache-2.0
// Through the real command line: updates that never return. Stand-ins hang; hooks: faulty_component_test.cpp.
#include <sstream>

#include "../system/system_test.hpp"

namespace segue::testing {
namespace {

using type::Value;

/// Two controllers: `work` has a task `slow` that the tests make hang, `rest` does without it.
class HangingRobot : public SystemTest {
 protected:
  /// `task`: more keys of the task `slow`; `process`: whether it has a process of its own.
  void write_robot(const std::string& hang, const std::string& task, bool process) {
    write("robot/robot.yaml",
          "robot: sleepy\ncontrollers: [\"*.net\"]\n"
          "policies: {watch: 50ms, restart: {backoff: 50ms, max: 3}}\n");
    const std::string place = process ? "deployments:\n  p: {host: localhost, tasks: [slow]}\n" : "";
    write("robot/work.net",
          "network: work\ntasks:\n"
          "  brisk: {component: \"any::Brisk\", activity: {periodic: 10ms}}\n"
          "  slow:\n    component: \"any::Slow\"\n"
          "    activity: {periodic: 10ms, update_deadline: 100ms}\n    properties: {stand_in: {hang: [" +
              hang + "]}}\n" + task + place);
    write("robot/rest.net",
          "network: rest\ntasks:\n  brisk: {component: \"any::Brisk\", activity: {periodic: 10ms}}\n");
  }
  void start(const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"run", "robot/robot.yaml", "--stand-in", "--controller", "work"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    robot_ = std::make_unique<Process>(command(std::move(arguments)), folder_);
    ASSERT_TRUE(robot_->wait_for("robot sleepy runs")) << robot_->wait().errors;
  }
  Value task(const std::string& id) {
    const auto status = json({"status"});
    for (const Value& one : status.find("tasks")->as_list()) {
      if (one.find("id")->as_string() == id) return one;
    }
    return {};
  }
  [[nodiscard]] bool becomes_fatal(const std::string& error) {
    Value slow;
    const bool is_fatal = eventually([&] {
      slow = task("slow");
      return slow.is_map() && slow.find("state")->as_string() == "fatal";
    });
    if (is_fatal) {
      EXPECT_NE(slow.find("error")->as_string().find(error), std::string::npos) << type::to_json(slow);
    }
    return is_fatal;
  }
  /// Switches; no action may fail, not even one that is gone round afterwards.
  void expect_switch(const std::string& controller) {
    const auto result = json({"switch", controller});
    EXPECT_EQ(result.find("outcome")->as_string(), "done") << type::to_json(result);
    for (const Value& action : result.find("actions")->as_list()) {
      EXPECT_EQ(action.find("outcome")->as_string(), "done") << type::to_json(action);
    }
  }
};

TEST_F(HangingRobot, SwitchesAwayFromAnUpdateThatNeverReturnsWithoutWaitingForIt) {
  write_robot("update", "", true);
  start();
  ASSERT_TRUE(becomes_fatal("on_update has not returned within 100ms; a transition replaces process "));
  EXPECT_GT(task("slow").find("missed")->as_int(), 0) << "cycles are missed while the update runs";
  EXPECT_EQ(task("brisk").find("state")->as_string(), "running");
  const auto drift = type::to_json(*json({"status"}).find("differences"));
  EXPECT_NE(drift.find("slow"), std::string::npos) << drift;
  expect_switch("rest");
  expect_switch("work");
  ASSERT_TRUE(becomes_fatal("on_update"));
  EXPECT_EQ(stop().status, 0);
}

TEST_F(HangingRobot, RestartsTheProcessOfAnUpdateThatNeverReturnsAsItsPolicySays) {
  write_robot("update", "    on_failure: restart\n", true);
  start();
  Process follower(command({"events", "--follow"}), folder_);
  EXPECT_TRUE(follower.wait_for("slow: fatal: on_update has not returned within 100ms"));
  EXPECT_TRUE(follower.wait_for("start slow")) << "it was started again";
  EXPECT_EQ(stop().status, 0);
}

TEST_F(HangingRobot, LeavesAnUpdateInItsOwnProcessBehindThatNeverReturns) {
  write_robot("update", "", false);
  start();
  ASSERT_TRUE(becomes_fatal("restart the runtime, and give the task a deployment of its own"));
  const auto refused = segue({"switch", "work"});
  EXPECT_EQ(refused.status, 1);
  EXPECT_NE(refused.errors.find("deployment of its own"), std::string::npos) << refused.errors;
  expect_switch("rest");
  EXPECT_FALSE(task("slow").is_map());
  expect_switch("work");
  ASSERT_TRUE(becomes_fatal("on_update"));
  const auto ended = stop();
  EXPECT_EQ(ended.status, 0) << ended.errors;
  EXPECT_NE(ended.errors.find("has not returned; the process ends without it"), std::string::npos)
      << ended.errors;
}

TEST_F(HangingRobot, LeavesATaskOfADeploymentThatRunsInItsOwnProcessBehind) {
  write_robot("update", "", true);
  start({"--in-process"});
  ASSERT_TRUE(becomes_fatal("on_update has not returned within 100ms"));
  expect_switch("rest");
  EXPECT_FALSE(task("slow").is_map());
  EXPECT_EQ(stop().status, 0);
}

}  // namespace
}  // namespace segue::testing

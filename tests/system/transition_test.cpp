// SPDX-License-Identifier: Apache-2.0
// Transitions that are written by hand, through the real command line.
#include <gmock/gmock.h>

#include "system_test.hpp"

namespace segue::testing {
namespace {

using ::testing::HasSubstr;
using type::Value;

class TransitionsByHand : public SystemTest {
 protected:
  void SetUp() override {
    SystemTest::SetUp();
    ASSERT_EQ(segue({"init", "rover"}).status, 0);
    std::ofstream(folder_ / "rover/robot.yaml", std::ios::app) << "transitions: [transitions/*.yaml]\n";
    write_restart("reset");
  }
  void write_restart(const std::string& operation) {
    write("rover/transitions/restart.yaml",
          "transition:\n  from: explore\n  to: explore\n  actions:\n"
          "    - {id: 1, kind: stop, task: odometry}\n"
          "    - {id: 2, kind: call_operation, task: odometry, operation: " +
              operation +
              ", after: [1]}\n"
              "    - {id: 3, kind: start, task: odometry, after: [2]}\n");
  }
};

TEST_F(TransitionsByHand, AreCheckedWithTheirRobot) {
  const auto good = segue({"check", "rover/robot.yaml"});
  EXPECT_EQ(good.status, 0) << good.errors;
  write_restart("forget");
  const auto bad = segue({"check", "rover/robot.yaml"});
  EXPECT_EQ(bad.status, 1);
  EXPECT_THAT(bad.errors, HasSubstr("restart.yaml:6:7: error: transition 'restart': action 2"));
  EXPECT_THAT(bad.errors, HasSubstr("component 'demo::Odometry' has no operation 'forget'"));
  const auto predicted =
      segue({"predict", "rover/controllers/explore.yaml", "rover/transitions/restart.yaml"});
  EXPECT_EQ(predicted.status, 1);
  EXPECT_THAT(predicted.errors, HasSubstr("component 'demo::Odometry' has no operation 'forget'"));
}

TEST_F(TransitionsByHand, AreRequestedByName) {
  start({"--controller", "explore"});
  ASSERT_NO_FATAL_FAILURE(wait_for_controller("explore"));
  const Value done = json({"switch", "--transition", "restart"});
  EXPECT_EQ(done.find("outcome")->as_string(), "done");
  EXPECT_EQ(done.find("actions")->as_list().size(), 3U);
  EXPECT_EQ(segue({"complete-names", "transitions"}).output, "restart\n");
  const auto unknown = segue({"switch", "--transition", "restat"});
  EXPECT_EQ(unknown.status, 1);
  EXPECT_THAT(unknown.errors, HasSubstr("no transition 'restat', did you mean 'restart'?"));
}

TEST_F(TransitionsByHand, AreCheckedAgainstWhatRunsBeforeTheirFirstAction) {
  start({"--controller", "hold"});
  ASSERT_NO_FATAL_FAILURE(wait_for_controller("hold"));
  write(
      "rover/wrong.yaml",
      "transition: {from: hold, to: hold, actions: [{kind: stop, task: drive}, {kind: cleanup, task: drive}, "
      "{kind: start, task: drive}]}\n");
  const auto refused = segue({"switch", "--transition", "rover/wrong.yaml"});
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.output + refused.errors, HasSubstr("action 3 (start drive) is not possible"));
  const Value status = json({"status"});
  for (const Value& task : status.find("tasks")->as_list())
    EXPECT_EQ(task.find("state")->as_string(), "running") << task.find("id")->as_string();
}

}  // namespace
}  // namespace segue::testing

// SPDX-License-Identifier: Apache-2.0
// Many missions on one robot, one after the other.
#include "system_test.hpp"

namespace segue::testing {
namespace {

/// Uses both controllers of the robot, and leaves the second one running.
constexpr const char* kToAndFro = R"(mission: to_and_fro
actions:
  drive:
    run:
      controller: go_to
      set: {seeker.speed: 2.0}
      call: {seeker.set_goal: {goal: {x: 100.0, y: 0.0}}}
      until: [{port: odometry.pose, where: 'x > -1000.0'}, {after: 5min, outcome: aborted}]
  look: {run: {controller: explore, until: [{after: 5ms, outcome: success}]}}
start: drive
states:
  drive: {on: {success: look}}
  look: {on: {success: return success}}
)";

class RepeatedMissions : public SystemTest {
 protected:
  void run_mission(int number) {
    const bool odd = number % 2 == 1;
    const auto run =
        segue({"mission", "run", "to_and_fro.yaml", "--mode", odd ? "concurrent" : "sequential"});
    ASSERT_EQ(run.status, 0) << run.output << run.errors;
  }
  /// What the last client held may take a moment to be closed.
  void expect_no_more_than(const Holdings& before) {
    Holdings now;
    EXPECT_TRUE(eventually([&] { return !has_grown(before, now = holdings_of(robot_->pid())); }))
        << "before: " << to_string(before) << "; now: " << to_string(now);
  }
};

TEST_F(RepeatedMissions, LeaveNothingBehind) {
  start();
  write("to_and_fro.yaml", kToAndFro);
  for (int i = 0; i < 4; ++i)
    ASSERT_NO_FATAL_FAILURE(run_mission(i));
  const Holdings before = holdings_of(robot_->pid());
  for (int i = 0; i < 20; ++i)
    ASSERT_NO_FATAL_FAILURE(run_mission(i)) << "the robot was free for the mission after the last one";
  expect_no_more_than(before);
  const auto ended = stop();
  EXPECT_EQ(ended.status, 0) << ended.errors;
}

}  // namespace
}  // namespace segue::testing

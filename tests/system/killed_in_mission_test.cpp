// SPDX-License-Identifier: Apache-2.0
// Processes of the robot are killed while a mission uses its controllers. SEGUE_KILLED_MISSIONS=50 runs as
// many missions, SEGUE_SEED=n another sequence of kills.
#include <support/number_from.hpp>

#include <gmock/gmock.h>

#include <chrono>
#include <csignal>
#include <random>
#include <thread>

#include "system_test.hpp"

namespace segue::testing {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;

/// Drives to where it never arrives.
constexpr const char* kEndless = R"(mission: endless
actions:
  drive_to:
    run:
      controller: go_to
      call: {seeker.set_goal: {goal: {x: 1000.0, y: 0.0}}}
      until: [{task: seeker, state: arrived}]
action: drive_to
)";

/// Uses one controller and the other, twice; what aborts is done again.
constexpr const char* kToAndFro = R"(mission: to_and_fro
actions:
  drive:
    run:
      controller: go_to
      call: {seeker.set_goal: {goal: {x: 1000.0, y: 0.0}}}
      until: [{port: odometry.pose, where: 'x > -1000.0'}, {after: 30s, outcome: aborted}]
  look: {run: {controller: explore, until: [{after: 100ms, outcome: success}]}}
start: out
states:
  out: {action: drive, on: {success: look, aborted: out}}
  look: {on: {success: back, aborted: look}}
  back: {action: drive, on: {success: look_again, aborted: back}}
  look_again: {action: look, on: {success: return success, aborted: look_again}}
)";

class KilledInMission : public SystemTest {
 protected:
  /// The robot with its tasks in processes.
  void start_robot(const std::string& on_failure) {
    ASSERT_EQ(segue({"init", "rover"}).status, 0);
    append("robot.yaml", "policies: {on_failure: " + on_failure + ", restart: {max: 3, backoff: 20ms}}\n");
    append("controllers/go_to.yaml",
           "deployments: {base: {tasks: [drive, odometry, laser]}, mind: {tasks: [guard, seeker]}}\n");
    append("controllers/explore.yaml",
           "deployments: {base: {tasks: [drive, odometry, laser]}, whim: {tasks: [wanderer]}}\n");
    start();
  }
  void append(const std::string& file, const std::string& text) const {
    std::ofstream(folder_ / "rover" / file, std::ios::app) << text;
  }
  std::map<std::string, pid_t> deployments() const { return deployments_of(folder_ / "runtime"); }
};

TEST_F(KilledInMission, AControllerThatIsLostIsReported) {
  ASSERT_NO_FATAL_FAILURE(start_robot("report"));
  write("endless.yaml", kEndless);
  for (const std::string mode : {"sequential", "concurrent"}) {
    SCOPED_TRACE(mode);
    Process mission(command({"mission", "run", "endless.yaml", "--mode", mode}), folder_);
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (controller() != "go_to" || !deployments().contains("mind")) {
      ASSERT_LT(std::chrono::steady_clock::now(), deadline);
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    ASSERT_EQ(::kill(deployments().at("mind"), SIGKILL), 0);
    const auto finished = mission.wait();
    EXPECT_EQ(finished.status, 1) << finished.output << finished.errors;
    EXPECT_THAT(finished.output + finished.errors, HasSubstr("endless: aborted"));
    // What is noticed first: the process, or the task in it.
    EXPECT_THAT(finished.output + finished.errors,
                AnyOf(HasSubstr("mind"), HasSubstr("no task 'seeker' runs")));
    EXPECT_EQ(segue({"switch", "explore"}).status, 0) << "the robot goes on";
  }
}

TEST_F(KilledInMission, WhatWasAbortedIsDoneAgainOnARobotThatRepairsItself) {
  ASSERT_NO_FATAL_FAILURE(start_robot("restart"));
  write("to_and_fro.yaml", kToAndFro);
  std::mt19937_64 random(static_cast<std::uint64_t>(number_from("SEGUE_SEED", 1)));
  const int missions = number_from("SEGUE_KILLED_MISSIONS", 4);
  for (int i = 0; i < missions && !HasFailure(); ++i) {
    SCOPED_TRACE("mission " + std::to_string(i));
    Process mission(command({"mission", "run", "to_and_fro.yaml", "--mode",
                             random() % 2 == 0 ? "sequential" : "concurrent"}),
                    folder_);
    for (int kills = 0; kills < 2; ++kills) {
      std::this_thread::sleep_for(std::chrono::milliseconds(random() % 400));
      const auto running = deployments();
      if (running.empty()) continue;
      const auto victim = std::next(running.begin(), static_cast<std::ptrdiff_t>(random() % running.size()));
      if (victim->second > 0) ::kill(victim->second, SIGKILL);
    }
    const auto finished = mission.wait();
    EXPECT_EQ(finished.status, 0) << finished.output << finished.errors;
  }
  EXPECT_EQ(segue({"switch", "go_to"}).status, 0);
  EXPECT_EQ(controller(), "go_to");
}

}  // namespace
}  // namespace segue::testing

// SPDX-License-Identifier: Apache-2.0
// Processes of the robot are killed while a mission uses its controllers. SEGUE_KILLED_MISSIONS=50 runs as
// many missions, SEGUE_SEED=n another sequence of kills.
#include <support/number_from.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <iterator>
#include <random>

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

/// Drives for some seconds.
constexpr const char* kFar = R"(mission: far
actions:
  drive_to:
    run:
      controller: go_to
      call: {seeker.set_goal: {goal: {x: 1.0, y: 0.5}}}
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
  [[nodiscard]] std::string read(const std::string& file) const {
    std::ifstream stream(folder_ / file);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  std::map<std::string, pid_t> deployments() const { return deployments_of(folder_ / "runtime"); }
  std::int64_t last_event() { return json({"events"}).as_list().back().find("number")->as_int(); }
  /// How many events the robot reports while nobody disturbs a mission.
  std::size_t events_of(const std::vector<std::string>& mission) {
    const auto before = last_event();
    const auto finished = segue(mission);
    EXPECT_EQ(finished.status, 0) << finished.output << finished.errors;
    return static_cast<std::size_t>(last_event() - before);
  }
  void kill_one(std::uint64_t which) const {
    const auto running = deployments();
    ASSERT_FALSE(running.empty());
    const auto victim = std::next(running.begin(), static_cast<std::ptrdiff_t>(which % running.size()));
    ASSERT_GT(victim->second, 0);
    ::kill(victim->second, SIGKILL);
  }
  /// Runs the mission and kills a process twice, each time after a random number of further events, together
  /// fewer than an undisturbed mission has. The kills that the robot reports are added to `reported`.
  void run_disturbed(const std::vector<std::string>& arguments, std::size_t events, std::mt19937_64& random,
                     int& reported) {
    const auto before = std::to_string(last_event());
    Process follower(command({"events", "--follow", "--after", before}), folder_);
    Process mission(command(arguments), folder_);
    std::size_t seen = 0;
    for (int kills = 0; kills < 2; ++kills) {
      seen += 1 + random() % (events * 2 / 5);
      const auto has_come = [&](const std::string& lines) {
        return static_cast<std::size_t>(std::ranges::count(lines, '\n')) >= seen;
      };
      ASSERT_TRUE(follower.wait_until(has_come)) << seen << " of " << events << " events";
      in_time_ += mission.has_ended() ? 0 : 1;  // what follows the events may lag behind
      ASSERT_NO_FATAL_FAILURE(kill_one(random()));
    }
    const auto finished = mission.wait();
    EXPECT_EQ(finished.status, 0) << finished.output << finished.errors;
    const auto after = json({"events", "--after", before});
    reported += static_cast<int>(std::ranges::count_if(after.as_list(), [](const auto& event) {
      return event.find("message")->as_string().find("SIGKILL") != std::string::npos;
    }));
  }

  int in_time_ = 0;  ///< processes that were killed while their mission went on
};

TEST_F(KilledInMission, AControllerThatIsLostIsReported) {
  ASSERT_NO_FATAL_FAILURE(start_robot("report"));
  write("endless.yaml", kEndless);
  for (const std::string mode : {"sequential", "concurrent"}) {
    SCOPED_TRACE(mode);
    Process mission(command({"mission", "run", "endless.yaml", "--mode", mode}), folder_);
    ASSERT_TRUE(eventually([&] { return controller() == "go_to" && deployments().contains("mind"); }));
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

TEST_F(KilledInMission, AnActionGoesOnWhereTheRobotRepairsItsController) {
  ASSERT_NO_FATAL_FAILURE(start_robot("restart"));
  write("far.yaml", kFar);
  for (const std::string mode : {"sequential", "concurrent"}) {
    for (const std::string process : {"mind", "base"}) {
      SCOPED_TRACE(mode + ", " + process);
      const std::string journal = "journal." + mode + "." + process;
      Process mission(command({"mission", "run", "far.yaml", "--mode", mode, "--journal", journal}), folder_);
      ASSERT_TRUE(eventually([&] { return read(journal).find("\"told\"") != std::string::npos; }));
      ASSERT_EQ(::kill(deployments().at(process), SIGKILL), 0);
      const auto finished = mission.wait();
      EXPECT_EQ(finished.status, 0) << finished.output << finished.errors;
      EXPECT_EQ(segue({"switch", ""}).status, 0) << "the next one begins where this one did";
    }
  }
}

TEST_F(KilledInMission, AnActionAbortsWhereTheRepairIsGivenUp) {
  ASSERT_NO_FATAL_FAILURE(start_robot("restart"));
  write("endless.yaml", kEndless);
  Process mission(command({"mission", "run", "endless.yaml", "--journal", "journal"}), folder_);
  ASSERT_TRUE(eventually([&] { return read("journal").find("\"told\"") != std::string::npos; }));
  for (int kills = 0; kills < 50 && !mission.has_ended(); ++kills) {
    ASSERT_TRUE(eventually([&] { return mission.has_ended() || deployments().contains("mind"); }));
    if (const auto all = deployments(); all.contains("mind")) ::kill(all.at("mind"), SIGKILL);
  }
  const auto finished = mission.wait();
  EXPECT_EQ(finished.status, 1);
  // A repair whose process is killed in its commit leaves nothing to be repaired.
  EXPECT_THAT(finished.output + finished.errors,
              AnyOf(HasSubstr("attempts have not helped"),
                    HasSubstr("controller 'go_to' was lost: the robot runs the empty network")));
}

TEST_F(KilledInMission, WhatWasAbortedIsDoneAgainOnARobotThatRepairsItself) {
  ASSERT_NO_FATAL_FAILURE(start_robot("restart"));
  write("to_and_fro.yaml", kToAndFro);
  std::mt19937_64 random(static_cast<std::uint64_t>(number_from("SEGUE_SEED", 1)));
  const int missions = number_from("SEGUE_KILLED_MISSIONS", 4);
  const auto run = [](const std::string& mode) {
    return std::vector<std::string>{"mission", "run", "to_and_fro.yaml", "--mode", mode};
  };
  ASSERT_EQ(segue({"switch", "explore"}).status, 0) << "which runs before and after every mission";
  std::map<std::string, std::size_t> events;
  for (const std::string mode : {"sequential", "concurrent"})
    ASSERT_GT(events[mode] = events_of(run(mode)), 20U);
  int reported = 0;
  for (int i = 0; i < missions && !HasFailure(); ++i) {
    const std::string mode = random() % 2 == 0 ? "sequential" : "concurrent";
    SCOPED_TRACE("mission " + std::to_string(i) + ", " + mode);
    run_disturbed(run(mode), events[mode], random, reported);
  }
  EXPECT_GE(reported, missions) << "processes that the robot did not miss were killed";
  EXPECT_GE(in_time_, missions) << "of two for each mission";
  EXPECT_EQ(segue({"switch", "go_to"}).status, 0);
  EXPECT_EQ(controller(), "go_to");
}

}  // namespace
}  // namespace segue::testing

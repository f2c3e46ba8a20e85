// SPDX-License-Identifier: Apache-2.0
// Plans of PDDL on the simulated rover, by the mapping of examples/08_rover/plan. SEGUE_ROVER_PLANS=20 moves
// the box in as many missions, SEGUE_SEED=n at other moments.
#include <support/number_from.hpp>

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <iostream>
#include <random>
#include <set>

#include "system_test.hpp"

namespace segue::testing {
namespace {

constexpr std::chrono::minutes kMissionPatience{5};

struct TablePlace {
  const char* name;
  double y;  ///< m, in the frame of the room
};
constexpr std::array kTablePlaces = {TablePlace{"left", 0.35}, TablePlace{"middle", 0.0},
                                     TablePlace{"right", -0.35}};
/// The steps in which the box is moved, each of which is needed once.
constexpr std::array kMovedDuring = {"drive_home_", "reach_red_", "approach_red_", "grip_red_", "lift_red_"};
/// They belong to every controller of the mission.
const std::set<std::string> kShared = {"rover", "wheels", "arm", "gripper", "trajectory"};

class RoverPlan : public SystemTest {
 protected:
  void SetUp() override {
    SystemTest::SetUp();
    std::filesystem::copy(segue::paths::in_sources("/examples/08_rover"), folder_ / "example",
                          std::filesystem::copy_options::recursive);
  }
  void start_rover() {
    robot_ = std::make_unique<Process>(command({"run", "example/robot.yaml"}), folder_);
    ASSERT_TRUE(robot_->wait_for("runs (pid"));
    const auto switched = segue({"switch", "go_to+guard"});
    ASSERT_EQ(switched.status, 0) << switched.errors;
  }
  void put_box(const TablePlace& place) {
    const auto moved = segue({"call", "rover.place_box", "box=1",
                              fmt::format("pose={{position: [1.62, {}, 0.33], orientation: {{w: 1.0, x: 0.0, "
                                          "y: 0.0, z: 0.0}}}}",
                                          place.y),
                              "--beside-mission"});
    EXPECT_EQ(moved.status, 0) << moved.errors;
  }
  static type::Value document(const Finished& finished) {
    const auto value = type::parse_json(finished.output);
    EXPECT_TRUE(value) << finished.output << finished.errors;
    return value.value_or(type::Value::map({}));
  }
  std::string state_of_gripper() {
    const auto status = json({"status"});
    const auto& tasks = status.find("tasks")->as_list();
    const auto gripper =
        std::ranges::find(tasks, "gripper", [](const auto& task) { return task.find("id")->as_string(); });
    return gripper == tasks.end() ? "" : gripper->find("state_name")->as_string();
  }
  void wait_until_runs(const std::string& state, const Process& mission) {
    const auto runs = [&] {
      return mission.has_ended() || segue({"mission", "status"}).output.find(state) != std::string::npos;
    };
    ASSERT_TRUE(eventually(runs)) << segue({"mission", "status"}).output;
    ASSERT_FALSE(mission.has_ended());
  }
  /// The tasks that transitions have stopped, or more, since the robot began.
  std::set<std::string> interrupted_tasks() {
    std::set<std::string> tasks;
    const auto history = json({"history"});
    for (const auto& transition : history.as_list()) {
      for (const auto& action : transition.find("actions")->as_list()) {
        const std::string kind = action.find("kind")->as_string();
        const auto* const task = action.find("task");
        if (task != nullptr && (kind == "stop" || kind == "cleanup" || kind == "recover"))
          tasks.insert(task->as_string());
      }
    }
    return tasks;
  }
  std::mt19937 random_{static_cast<std::mt19937::result_type>(number_from("SEGUE_SEED", 29))};
};

TEST_F(RoverPlan, IsMadeAnewWhereTheBoxIsMoved) {
  for (int round = 0; round < number_from("SEGUE_ROVER_PLANS", 1); ++round) {
    const std::size_t from = random_() % kTablePlaces.size();
    const std::size_t to = (from + 1 + random_() % 2) % kTablePlaces.size();
    const std::string during = kMovedDuring.at(random_() % kMovedDuring.size());
    const auto story = fmt::format("{}: moved during {} from {} to {}", round, during,
                                   kTablePlaces.at(from).name, kTablePlaces.at(to).name);
    SCOPED_TRACE(story);
    start_rover();
    put_box(kTablePlaces.at(from));
    Process mission(command({"mission", "plan", "example/plan/mapping.yaml", "example/plan/fetch_red.pddl",
                             "--run", "--format", "json"}),
                    folder_);
    wait_until_runs(during, mission);
    put_box(kTablePlaces.at(to));
    const auto finished = mission.wait(kMissionPatience);
    ASSERT_EQ(finished.status, 0) << finished.output << finished.errors;
    const auto ran = document(finished);
    EXPECT_TRUE(ran.find("goal_holds")->as_bool());
    const auto& runs = ran.find("runs")->as_list();
    EXPECT_GE(runs.size(), 2U) << finished.output;
    EXPECT_EQ(state_of_gripper(), "holding");
    for (const std::string& task : interrupted_tasks())
      EXPECT_FALSE(kShared.contains(task)) << task << " was interrupted";
    std::cout << story << ": the goal holds after " << runs.size() << " plans\n";
    EXPECT_EQ(stop().status, 0);
  }
}

/// What Fast Downward, FF and a temporal planner of unified-planning write: each does a part of the work.
TEST_F(RoverPlan, IsTakenFromThreePlanners) {
  struct Part {
    const char* init;
    const char* goal;
    const char* plan;
  };
  constexpr std::array kParts = {
      Part{"(at home) (folded)", "(and (raised) (at middle))",
           "(raise )\n(drive home middle )\n; cost = 2 (unit cost)\n"},
      Part{
          "(at middle) (folded) (raised)", "(around red middle)",
          "ff: found legal plan as follows\n\nstep    0: REACH RED MIDDLE\n        1: APPROACH RED MIDDLE\n\n"
          "time spent:    0.00 seconds total time\n"},
      Part{"(at middle) (around red middle)", "(and (at home) (full))",
           "0.000: (grip red middle) [1.000]\n1.001: (lift red middle) [1.000]\n"
           "2.002: (drive middle home) [1.000]\n"}};
  start_rover();
  put_box(kTablePlaces.at(1));
  for (const Part& part : kParts) {
    SCOPED_TRACE(part.plan);
    write("example/plan/part.pddl",
          fmt::format("(define (problem part) (:domain fetch) (:objects home left middle right - place red - "
                      "box)\n(:init (on red middle) {}) (:goal {}))",
                      part.init, part.goal));
    write("plan.txt", part.plan);
    const auto made = segue({"mission", "plan", "example/plan/mapping.yaml", "example/plan/part.pddl",
                             "--plan", "plan.txt", "-o", "example/part.yaml"});
    ASSERT_EQ(made.status, 0) << made.errors;
    const auto ran =
        Process(command({"mission", "run", "example/part.yaml", "--mode", "concurrent"}), folder_)
            .wait(kMissionPatience);
    ASSERT_EQ(ran.status, 0) << ran.output << ran.errors;
  }
  EXPECT_EQ(state_of_gripper(), "holding");
}

}  // namespace
}  // namespace segue::testing

// SPDX-License-Identifier: Apache-2.0
// Planner, camera, controllers, watch, runtime or the mission itself are killed while the simulated rover
// brings a box to its deck. SEGUE_KILLED_MISSIONS=50 runs as many missions, SEGUE_SEED=n other ones.
#include <support/number_from.hpp>

#include <gmock/gmock.h>

#include <Eigen/Core>
#include <iostream>
#include <random>
#include <set>

#include "system_test.hpp"

namespace segue::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class RoverKilled : public SystemTest {
 protected:
  /// The robot of the example with all tasks in processes. What the rover is made of, and the world around
  /// it, is one process, which is spared.
  void make_robot() {
    const auto example = segue::paths::in_sources("/examples/08_rover");
    std::filesystem::remove_all(folder_ / "example");
    std::filesystem::copy(example, folder_ / "example", std::filesystem::copy_options::recursive);
    const std::string body = "  body: {tasks: [rover, wheels, arm, gripper]}\n";
    append("table/survey.yaml", body + "  eyes: {tasks: [observer]}\n");
    append("table/carry.yaml", "deployments:\n" + body + "  hand: {tasks: [follower]}\n");
    append("table/hold.yaml", "deployments:\n" + body);
    append("table/guard.yaml",
           "deployments:\n  body: {tasks: [rover]}\n  watch: {tasks: [battery, stop_button]}\n");
    append("table_robot.yaml", "policies: {on_failure: restart, restart: {max: 3, backoff: 20ms}}\n");
  }
  void append(const std::string& file, const std::string& text) const {
    std::ofstream(folder_ / "example" / file, std::ios::app) << text;
  }
  void start_runtime() {
    robot_ = std::make_unique<Process>(command({"run", "example/table_robot.yaml"}), folder_);
    ASSERT_TRUE(robot_->wait_for("runs (pid"));
  }
  [[nodiscard]] std::vector<std::string> mission(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"mission",      "run",       "example/clear_table.yaml",
                                          "--format",     "json",      "--input",
                                          "boxes=1",      "--journal", "run.journal",
                                          "--no-progress"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return command(arguments);
  }
  /// A process of the robot, "runtime" or "mission"; the ones that exist at the time.
  std::string kill_one(Process& mission) {
    auto victims = deployments_of(folder_ / "runtime");
    victims.erase("body");
    victims["runtime"] = robot_->pid();
    victims["mission"] = mission.pid();
    const auto victim = std::next(victims.begin(), static_cast<std::ptrdiff_t>(random_() % victims.size()));
    if (victim->second > 0) ::kill(victim->second, SIGKILL);
    return victim->first;
  }
  /// Empty where the mission was refused.
  static std::string outcome_of(const Finished& finished) {
    const auto result = type::parse_json(finished.output);
    const auto* const outcome = result ? result->find("outcome") : nullptr;
    return outcome == nullptr ? "" : outcome->as_string();
  }
  /// Runs the mission and kills a process in the middle, and whatever is needed is started again.
  Finished run_disturbed(const std::string& mode, std::string& killed) {
    Process process(mission({"--mode", mode}), folder_);
    std::this_thread::sleep_for(std::chrono::milliseconds(random_() % 8000));
    killed = kill_one(process);
    auto finished = process.wait();
    if (killed != "runtime" && killed != "mission") return finished;
    if (killed == "runtime") {
      EXPECT_NE(finished.status, 0) << "a mission does not succeed without its runtime";
      EXPECT_THAT(finished.errors, Not(IsEmpty()));
      robot_->wait();
      start_runtime();
    }
    if (!std::filesystem::exists(folder_ / "run.journal")) return run(mission({"--mode", mode}), folder_);
    finished = run(mission({"--mode", mode, "--resume"}), folder_);
    if (!outcome_of(finished).empty()) return finished;
    EXPECT_THAT(finished.output, HasSubstr("error")) << "it says why it does not go on";
    return run(mission({"--mode", mode, "--resume", "--under-way", "abort"}), folder_);
  }
  /// Irreversible actions whose tasks were told more than once what to do.
  std::set<std::string> repeated() const {
    std::set<std::string> told;
    std::set<std::string> again;
    std::ifstream journal(folder_ / "run.journal");
    for (std::string line; std::getline(journal, line);) {
      const auto entry = type::parse_json(line);
      const auto* const state = entry ? entry->find("progressed") : nullptr;
      if (state == nullptr || entry->find("to")->find("stage")->as_string() != "told") continue;
      const auto name = state->as_string() + " " + std::to_string(entry->find("n")->as_int());
      if (!told.insert(name).second) again.insert(name);
    }
    return again;
  }
  double distance_to_place() {
    const auto sample = json({"read", "rover.boxes"});
    const auto& position = sample.find("markers")->as_list().at(0).find("pose")->find("position")->as_list();
    const Eigen::Vector3d box(position.at(0).as_double(), position.at(1).as_double(),
                              position.at(2).as_double());
    return (box - Eigen::Vector3d(0.85 + 0.05, -0.27, 0.34)).norm();  // as the mission says
  }

  std::mt19937_64 random_{static_cast<std::uint64_t>(number_from("SEGUE_SEED", 1))};
};

TEST_F(RoverKilled, EndsWellOrSaysWhyNot) {
  std::map<std::string, std::map<std::string, int>> ends;
  const int missions = number_from("SEGUE_KILLED_MISSIONS", 2);
  for (int i = 0; i < missions && !HasFailure(); ++i) {
    make_robot();
    ASSERT_NO_FATAL_FAILURE(start_runtime());
    const std::string mode = random_() % 2 == 0 ? "sequential" : "concurrent";
    std::string killed;
    const auto finished = run_disturbed(mode, killed);
    SCOPED_TRACE("mission " + std::to_string(i) + ", " + mode + ", killed: " + killed);
    const auto outcome = outcome_of(finished);
    std::string error;
    if (outcome == "done") {
      EXPECT_LT(distance_to_place(), 0.03) << "it says that the box is on the deck";
    } else {
      EXPECT_EQ(outcome, "aborted") << finished.output << finished.errors;
      const auto result = type::parse_json(finished.output);
      const auto* const reason = result ? result->find("error") : nullptr;
      error = reason != nullptr && reason->is_string() ? reason->as_string() : "";
      EXPECT_THAT(error, Not(IsEmpty()));
    }
    EXPECT_THAT(repeated(), IsEmpty());
    const auto switched = segue({"switch", "hold"});
    EXPECT_EQ(switched.status, 0) << switched.errors;
    EXPECT_EQ(stop().status, 0);
    std::filesystem::remove(folder_ / "run.journal");
    ++ends[killed][outcome];
    if (missions > 2) {
      std::cout << i << ' ' << mode << ", killed " << killed << ": " << outcome << "  " << error << std::endl;
    }
  }
  for (const auto& [killed, outcomes] : ends) {
    for (const auto& [outcome, count] : outcomes)
      std::cout << killed << " killed: " << count << " x " << outcome << '\n';
  }
}

}  // namespace
}  // namespace segue::testing

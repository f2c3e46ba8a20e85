// SPDX-License-Identifier: Apache-2.0
// Planner, camera, controllers, watch, runtime or the mission itself are killed while the simulated rover
// brings a box to its deck. SEGUE_KILLED_MISSIONS=50 runs as many missions, SEGUE_SEED=n other ones.
#include <support/number_from.hpp>

#include <gmock/gmock.h>

#include <Eigen/Core>
#include <algorithm>
#include <chrono>
#include <iostream>
#include <iterator>
#include <random>
#include <set>

#include "system_test.hpp"

namespace segue::testing {
namespace {

using ::testing::_;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// How long a mission may take on a busy computer.
constexpr std::chrono::minutes kMissionPatience{5};

/// How many entries the journal of a mission has when the rover begins to carry the box, which takes seconds;
/// the concurrent one does not record that computations begin.
std::size_t entries_until_it_carries(const std::string& mode) {
  return mode == "sequential" ? 41 : 30;
}

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
    give_plans_time();
    append("table_robot.yaml", "policies: {on_failure: restart, restart: {max: 3, backoff: 20ms}}\n");
  }
  /// The computer may be so busy that no plan is found within seconds, for which no killed process is to
  /// blame.
  void give_plans_time() const {
    std::ifstream file(folder_ / "example/bring_boxes.yaml");
    std::string text{std::istreambuf_iterator<char>(file), {}};
    const std::string pool = "      pool: planner\n";
    const std::string timeout = "      timeout: 5min\n";
    int changed = 0;
    for (auto at = text.find(pool); at != std::string::npos; at = text.find(pool, at + timeout.size() + 1)) {
      text.insert(at, timeout);
      ++changed;
    }
    ASSERT_EQ(changed, 2);
    write("example/bring_boxes.yaml", text);
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
    EXPECT_EQ(::kill(victim->second, SIGKILL), 0) << victim->first;
    return victim->first;
  }
  [[nodiscard]] std::size_t entries() const {
    std::ifstream journal(folder_ / "run.journal");
    return static_cast<std::size_t>(std::count(std::istreambuf_iterator<char>(journal), {}, '\n'));
  }
  Finished run_mission(const std::vector<std::string>& more) {
    return Process(mission(more), folder_).wait(kMissionPatience);
  }
  /// Whether the robot reports that the process was killed. What it ends itself just then, it does not miss.
  bool is_reported(const std::string& killed) {
    const auto events = json({"events"});
    return std::ranges::any_of(events.as_list(), [&](const auto& event) {
      const auto subject = event.find("subject")->as_string();
      const auto message = event.find("message")->as_string();
      return (subject.ends_with(killed) && message.find("SIGKILL") != std::string::npos) ||
             subject == "undeploy localhost/" + killed;
    });
  }
  /// Empty where the mission was refused.
  static std::string outcome_of(const Finished& finished) {
    const auto result = type::parse_json(finished.output);
    const auto* const outcome = result ? result->find("outcome") : nullptr;
    return outcome == nullptr ? "" : outcome->as_string();
  }
  /// Why a mission may abort where that process was killed. It begins its watch again, so it does not abort
  /// because of that; without runtime or mission it goes on, but for an action that was being told what to
  /// do.
  static ::testing::Matcher<std::string> reason_for(const std::string& killed) {
    if (killed == "hand") return AnyOf(HasSubstr("'hand'"), HasSubstr("'follower'"));
    if (killed == "vision")
      return AnyOf(HasSubstr("'vision'"), HasSubstr("'camera'"), HasSubstr("'detector'"));
    if (killed == "eyes") return AnyOf(HasSubstr("'eyes'"), HasSubstr("'observer'"));
    if (killed == "planner_1") return AnyOf(HasSubstr("planner_1"), HasSubstr("no plan has been found"));
    if (killed == "runtime" || killed == "mission")
      return HasSubstr("it had begun but not ended when the earlier run was interrupted");
    return Not(_);
  }
  /// Runs the mission and kills a process in the middle, and whatever is needed is started again.
  Finished run_disturbed(const std::string& mode, std::string& killed) {
    Process process(mission({"--mode", mode}), folder_);
    const std::size_t at = 1 + random_() % entries_until_it_carries(mode);
    EXPECT_TRUE(eventually([&] { return entries() >= at || process.has_ended(); }, kMissionPatience));
    EXPECT_FALSE(process.has_ended()) << "after " << entries() << " entries of its journal, not " << at;
    killed = kill_one(process);
    auto finished = process.wait(kMissionPatience);
    if (killed != "runtime" && killed != "mission") {
      EXPECT_TRUE(eventually([&] { return is_reported(killed); })) << segue({"events"}).output;
      return finished;
    }
    if (killed == "mission") {
      EXPECT_EQ(finished.status, 128 + SIGKILL);
    } else {
      EXPECT_EQ(finished.status, 1) << "a mission does not succeed without its runtime";
      EXPECT_THAT(finished.errors, HasSubstr("the robot cannot be reached any more"));
      EXPECT_EQ(robot_->wait().status, 128 + SIGKILL);
      start_runtime();
    }
    finished = run_mission({"--mode", mode, "--resume"});
    if (!outcome_of(finished).empty()) return finished;
    EXPECT_THAT(finished.output, HasSubstr("error")) << "it says why it does not go on";
    return run_mission({"--mode", mode, "--resume", "--under-way", "abort"});
  }
  /// Irreversible actions whose tasks were told what to do once more than they may be. Where a task's process
  /// was killed, the task has begun anew and knows nothing of it, so an action that has not ended tells it
  /// again.
  std::set<std::string> repeated(const std::string& killed) const {
    const bool begins_anew = killed != "mission" && killed != "runtime";
    std::set<std::string> under_way;
    std::set<std::string> ended;
    std::set<std::string> again;
    std::ifstream journal(folder_ / "run.journal");
    for (std::string line; std::getline(journal, line);) {
      const auto entry = type::parse_json(line);
      if (!entry) continue;
      const auto name_at = [&](const char* what) {
        const auto* const state = entry->find(what);
        return state == nullptr ? "" : state->as_string() + " " + std::to_string(entry->find("n")->as_int());
      };
      if (const auto name = name_at("ended"); !name.empty()) ended.insert(name);
      const auto name = name_at("progressed");
      if (name.empty() || entry->find("to")->find("stage")->as_string() != "told") continue;
      const bool is_told_again = !under_way.insert(name).second;
      if (ended.contains(name) || (is_told_again && !begins_anew)) again.insert(name);
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
    ASSERT_NO_FATAL_FAILURE(make_robot());
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
      EXPECT_THAT(error, reason_for(killed));
    }
    EXPECT_THAT(repeated(killed), IsEmpty());
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

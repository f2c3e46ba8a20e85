// SPDX-License-Identifier: Apache-2.0
//
// A running robot whose files are edited, and networks that are sent to it.
#include <segue/base/sha256.hpp>

#include <algorithm>
#include <sstream>

#include "system_test.hpp"

namespace segue::testing {
namespace {

using type::Value;

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// The robot of `segue init` runs `explore`.
class EditedRobot : public SystemTest {
 protected:
  void run_explore() {
    start({"--controller", "explore"});
    ASSERT_EQ(segue({"switch", "explore"}).status, 0);
  }
  [[nodiscard]] std::string content(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(folder_ / name).rdbuf();
    return text.str();
  }
  void edit(const std::string& name, const std::string& from, const std::string& to) const {
    std::string text = content(name);
    const auto at = text.find(from);
    ASSERT_NE(at, std::string::npos) << text;
    write(name, text.replace(at, from.size(), to));
  }
  void remove(const std::string& name) const { std::filesystem::remove(folder_ / name); }
  std::string text_of_status(const std::string& field) { return json({"status"}).find(field)->as_string(); }
  Value speed() { return *json({"task", "wanderer"}).find("properties")->find("speed"); }

  static constexpr const char* kExplore = "rover/controllers/explore.yaml";
};

TEST_F(EditedRobot, AnEditIsSeenPlannedAndApplied) {
  run_explore();
  EXPECT_TRUE(json({"status"}).find("changed_files")->as_list().empty());
  EXPECT_EQ(segue({"plan", "--exit-code"}).status, 0);
  const std::string before = text_of_status("version");
  EXPECT_EQ(before, sha256(content(kExplore)).substr(0, 12));

  edit(kExplore, "speed: 0.4", "speed: 0.6");
  const auto status = segue({"status"});
  EXPECT_TRUE(contains(status.output, "changed since it was loaded: rover/controllers/explore.yaml"))
      << status.output;
  EXPECT_TRUE(contains(status.output, "`segue plan`")) << status.output;
  const auto plan = segue({"plan", "--exit-code"});
  EXPECT_EQ(plan.status, 4) << plan.errors;
  for (const char* part : {"explore: changed (rover/controllers/explore.yaml, ", "it runs",
                           "task 'wanderer': property 'speed': 0.4 -> 0.6", "explore -> explore: "})
    EXPECT_TRUE(contains(plan.output, part)) << part << " in\n" << plan.output;
  EXPECT_EQ(speed(), Value(0.4)) << "a plan changes nothing";
  EXPECT_EQ(text_of_status("version"), before);
  const auto planned = json({"plan"});

  const auto applied = json({"apply"});
  EXPECT_EQ(applied.find("outcome")->as_string(), "done");
  const auto& actions = applied.find("transition")->find("actions")->as_list();
  EXPECT_EQ(actions.size(), planned.find("transition")->find("actions")->as_list().size());
  for (const Value& action : actions)
    EXPECT_TRUE(contains(type::to_json(action), "wanderer")) << type::to_json(action);
  EXPECT_EQ(speed(), Value(0.6));
  EXPECT_EQ(text_of_status("version"), sha256(content(kExplore)).substr(0, 12));
  EXPECT_TRUE(json({"status"}).find("changed_files")->as_list().empty());
  const auto again = segue({"apply"});
  EXPECT_EQ(again.status, 0);
  EXPECT_TRUE(contains(again.output, "no controller has changed\napplied")) << again.output;
}

TEST_F(EditedRobot, TheJournalKeepsWhichVersionRan) {
  run_explore();
  const std::string before = text_of_status("version");
  edit(kExplore, "speed: 0.4", "speed: 0.6");
  ASSERT_EQ(segue({"apply"}).status, 0);
  const std::string after = text_of_status("version");
  const auto running = segue({"history"});
  EXPECT_TRUE(contains(running.output, "version " + before)) << running.output;
  EXPECT_TRUE(contains(running.output, "explore -> explore (apply): done")) << running.output;
  EXPECT_TRUE(contains(running.output, "version " + after)) << running.output;
  (void)stop();
  const auto entries = json({"history", "--all", "--robot", "rover"}).as_list();
  const auto found = std::ranges::find_if(
      entries, [](const Value& entry) { return entry.find("cause")->as_string() == "apply"; });
  ASSERT_NE(found, entries.end());
  EXPECT_EQ(found->find("from_version")->as_string(), before);
  EXPECT_EQ(found->find("runs_version")->as_string(), after);
  const auto versions = segue({"history", "--versions", "--robot", "rover"});
  for (const std::string& version : {before, after})
    EXPECT_TRUE(contains(versions.output, "explore " + version + " (rover/controllers/explore.yaml)"))
        << versions.output;
  const auto listed = json({"history", "--versions", "--robot", "rover"});
  for (const Value& version : listed.as_list())
    EXPECT_TRUE(contains(version.find("text")->as_string(), "network: ")) << type::to_json(version);
}

TEST_F(EditedRobot, NewFilesAppearAndOthersGo) {
  run_explore();
  write("rover/controllers/look.yaml",
        "network: look\ntasks:\n  laser: {component: \"demo::LaserScanner\"}\n");
  remove("rover/controllers/manual.yaml");
  edit(kExplore, "# Wanders", "# Wanders slowly");
  const auto applied = segue({"apply"});
  EXPECT_EQ(applied.status, 0) << applied.errors;
  for (const char* part :
       {"look: added (rover/controllers/look.yaml, ", "manual: removed (rover/controllers/manual.yaml, ",
        "    the network is the same\n"})
    EXPECT_TRUE(contains(applied.output, part)) << part << " in\n" << applied.output;
  EXPECT_EQ(text_of_status("version"), sha256(content(kExplore)).substr(0, 12));
  EXPECT_EQ(json({"switch", "look"}).find("outcome")->as_string(), "done");
  EXPECT_EQ(json({"switch", "manual"}, 1).find("outcome")->as_string(), "refused");
}

TEST_F(EditedRobot, AControllerThatRunsOutlivesItsFile) {
  run_explore();
  remove(kExplore);
  const auto plan = segue({"plan"});
  EXPECT_TRUE(contains(plan.output, "explore: removed")) << plan.output;
  EXPECT_TRUE(contains(plan.output, "it keeps running until the next switch")) << plan.output;
  const auto applied = segue({"apply"});
  EXPECT_EQ(applied.status, 0) << applied.errors;
  EXPECT_TRUE(contains(applied.output, "it keeps running until the next switch")) << applied.output;
  const auto status = segue({"status"});
  EXPECT_TRUE(contains(status.output, "controller explore")) << status.output;
  EXPECT_TRUE(contains(status.output, "'explore' is none of the robot's controllers")) << status.output;
  EXPECT_EQ(segue({"switch", "manual"}).status, 0);
  EXPECT_EQ(segue({"switch", "explore"}).status, 1);
}

TEST_F(EditedRobot, FilesWithErrorsAreRefusedAndTheOldOnesKept) {
  run_explore();
  const std::string before = text_of_status("version");
  edit(kExplore, "speed: 0.4", "speed: 0.6");
  write("rover/controllers/bad.yaml", "network: bad\ntasks:\n  a: {component: \"demo::Nothing\"}\n");
  write("rover/controllers/worse.yaml", "network: worse\ntasks: 3\n");
  for (const char* verb : {"plan", "apply"}) {
    const auto refused = segue({verb});
    EXPECT_EQ(refused.status, 1) << verb;
    EXPECT_TRUE(contains(refused.errors, "rover/controllers/worse.yaml:2:8: error: ")) << refused.errors;
    EXPECT_TRUE(contains(refused.errors, "segue: error: the files cannot be used\n")) << refused.errors;
    EXPECT_EQ(refused.errors.find("worse.yaml"), refused.errors.rfind("worse.yaml")) << refused.errors;
    EXPECT_EQ(json({verb}, 1).find("outcome")->as_string(), "refused");
  }
  remove("rover/controllers/worse.yaml");
  const auto unknown = segue({"apply"});
  EXPECT_EQ(unknown.status, 1);
  EXPECT_TRUE(contains(unknown.errors, "rover/controllers/bad.yaml:3:")) << unknown.errors;
  EXPECT_TRUE(contains(unknown.errors, "demo::Nothing")) << unknown.errors;
  EXPECT_EQ(unknown.errors.find("bad.yaml"), unknown.errors.rfind("bad.yaml")) << unknown.errors;
  EXPECT_EQ(text_of_status("version"), before);
  EXPECT_EQ(text_of_status("loaded_version"), before);
  EXPECT_EQ(speed(), Value(0.4));
  EXPECT_EQ(json({"status"}).find("changed_files")->as_list().size(), 2U);
  remove("rover/controllers/bad.yaml");
  EXPECT_EQ(segue({"apply"}).status, 0);
  EXPECT_EQ(speed(), Value(0.6));
}

TEST_F(EditedRobot, APlanForAnotherControllerUsesItsFileAsItIsNow) {
  run_explore();
  edit("rover/controllers/manual.yaml", "  joystick: {component: \"demo::Joystick\"}",
       "  joystick: {component: \"demo::Joystick\", state: stopped}");
  const auto plan = json({"plan", "manual"});
  EXPECT_EQ(plan.find("controller")->as_string(), "manual");
  EXPECT_EQ(plan.find("transition")->find("to")->as_string(), "manual");
  for (const Value& action : plan.find("transition")->find("actions")->as_list())
    EXPECT_FALSE(action.find("kind")->as_string() == "start" &&
                 action.find("task")->as_string() == "joystick");
  const auto unknown = segue({"plan", "manaul"});
  EXPECT_EQ(unknown.status, 1);
  EXPECT_TRUE(contains(unknown.errors, "did you mean 'manual'?")) << unknown.errors;
}

TEST_F(EditedRobot, AnEditMayAddAProcess) {
  run_explore();
  write(kExplore, content(kExplore) + "deployments:\n  eyes: {process: eyes, tasks: [laser]}\n");
  const auto applied = json({"apply"});
  EXPECT_EQ(applied.find("outcome")->as_string(), "done");
  const auto status = json({"status"});
  for (const Value& task : status.find("tasks")->as_list()) {
    const bool moved = task.find("id")->as_string() == "laser";
    EXPECT_EQ(task.find("process")->as_string(), moved ? "eyes" : "");
  }
  EXPECT_TRUE(status.find("differences")->as_list().empty());
}

/// Its tasks are stand-ins, which fail or take their time as the files say.
class EditedStandIns : public EditedRobot {
 protected:
  void SetUp() override {
    EditedRobot::SetUp();
    write("rover/robot.yaml", "robot: rover\nhosts: {onboard: local}\ncontrollers: [\"*.net\"]\n");
    write("rover/look.net", "network: look\ntasks:\n  eye: {component: \"x::Eye\", properties: {gain: 1}}\n");
    write("rover/walk.net",
          "network: walk\ntasks:\n  leg: {component: \"x::Leg\", properties: {gain: 1, stand_in: {configure: "
          "300ms}}}\n");
    start({"--stand-in", "--controller", "look"});
    ASSERT_EQ(segue({"switch", "look"}).status, 0);
  }
};

TEST_F(EditedStandIns, ATransitionThatFailsIsUndoneWithItsFiles) {
  const std::string before = text_of_status("version");
  edit("rover/look.net", "gain: 1", "gain: 2, stand_in: {fail: configure}");
  edit("rover/walk.net", "gain: 1", "gain: 2");
  const auto failed = segue({"apply"});
  EXPECT_EQ(failed.status, 1);
  EXPECT_TRUE(contains(failed.output, "failed: controllers unchanged")) << failed.output;
  EXPECT_TRUE(contains(failed.errors, "the robot runs 'look' as before")) << failed.errors;
  const auto status = json({"status"});
  EXPECT_EQ(status.find("version")->as_string(), before);
  EXPECT_EQ(status.find("loaded_version")->as_string(), before);
  EXPECT_TRUE(status.find("differences")->as_list().empty()) << "the old version is the wanted one";
  EXPECT_EQ(status.find("changed_files")->as_list().size(), 2U);
  EXPECT_EQ(*json({"task", "eye"}).find("properties")->find("gain"), Value(1));
  edit("rover/look.net", ", stand_in: {fail: configure}", "");
  EXPECT_EQ(segue({"apply"}).status, 0);
  EXPECT_EQ(*json({"task", "eye"}).find("properties")->find("gain"), Value(2));
}

TEST_F(EditedStandIns, FilesAreAppliedWhileASwitchIsInProgress) {
  Process switching(command({"switch", "walk"}), folder_);
  ASSERT_TRUE(robot_->wait_for("from 'look' to 'walk'"));
  edit("rover/walk.net", "gain: 1", "gain: 2");
  EXPECT_EQ(json({"apply"}).find("outcome")->as_string(), "done");
  EXPECT_EQ(switching.wait().status, 0) << "it was not superseded";
  const auto status = json({"status"});
  EXPECT_EQ(status.find("controller")->as_string(), "walk");
  EXPECT_EQ(status.find("version")->as_string(), sha256(content("rover/walk.net")).substr(0, 12));
  EXPECT_EQ(*json({"task", "leg"}).find("properties")->find("gain"), Value(2));
}

using SentNetwork = EditedRobot;

TEST_F(SentNetwork, ARobotSwitchesToANetworkThatIsSent) {
  run_explore();
  write("try.yaml",
        "network: try_it\ntasks:\n  drive: {component: \"demo::Drive\", properties: {max_speed: 0.3}}\n");
  const auto plan = json({"switch", "--network", "try.yaml", "--dry-run"});
  EXPECT_EQ(plan.find("to")->as_string(), "try_it");
  const auto result = json({"switch", "--network", "try.yaml"});
  EXPECT_EQ(result.find("outcome")->as_string(), "done");
  const auto status = json({"status"});
  EXPECT_EQ(status.find("controller")->as_string(), "try_it");
  EXPECT_EQ(status.find("version")->as_string(), sha256(content("try.yaml")).substr(0, 12));
  EXPECT_TRUE(status.find("loaded_version")->is_null());
  EXPECT_EQ(segue({"switch", "try_it"}).status, 1) << "it is none of the robot's controllers";
  EXPECT_EQ(segue({"switch", "explore"}).status, 0);
  const auto versions = segue({"history", "--versions"});
  EXPECT_TRUE(
      contains(versions.output, "try_it " + sha256(content("try.yaml")).substr(0, 12) + " (try.yaml)"))
      << versions.output;
}

TEST_F(SentNetwork, ItIsSentWithTheFilesThatItIncludes) {
  run_explore();
  write("slow.yaml",
        "network: slow\ninclude: rover/controllers/explore.yaml\n"
        "tasks:\n  wanderer: {component: \"demo::Wanderer\", properties: {speed: 0.1}}\n");
  const auto result = json({"switch", "--network", "slow.yaml"});
  EXPECT_EQ(result.find("outcome")->as_string(), "done");
  EXPECT_EQ(result.find("actions")->as_list().size(), 1U) << "only the speed differs";
  write("slow.yaml", "network: slow\ninclude: gone.yaml\n");
  const auto refused = segue({"switch", "--network", "slow.yaml"});
  EXPECT_EQ(refused.status, 1);
  EXPECT_TRUE(contains(refused.errors, "slow.yaml:2:10: cannot read 'gone.yaml'")) << refused.errors;
}

TEST_F(SentNetwork, ItsNameMustNotBeThatOfAnotherController) {
  run_explore();
  write("mine.yaml", "network: manual\ntasks:\n  drive: {component: \"demo::Drive\"}\n");
  const auto refused = segue({"switch", "--network", "mine.yaml"});
  EXPECT_EQ(refused.status, 1);
  EXPECT_TRUE(contains(refused.errors, "the robot has another controller 'manual'")) << refused.errors;
  EXPECT_EQ(text_of_status("controller"), "explore");
  EXPECT_EQ(segue({"switch", "--network", "rover/controllers/manual.yaml"}).status, 0) << "it is the same";
}

TEST_F(SentNetwork, ItIsCheckedAndLimited) {
  run_explore();
  write("bad.yaml", "network: bad\ntasks:\n  a: {component: \"demo::Nothing\"}\n");
  const auto bad = segue({"switch", "--network", "bad.yaml"});
  EXPECT_EQ(bad.status, 1);
  EXPECT_TRUE(contains(bad.errors, "bad.yaml:3:")) << bad.errors;
  write("worse.yaml", "network: worse\ntasks: 3\n");
  const auto worse = segue({"switch", "--network", "worse.yaml"});
  EXPECT_EQ(worse.status, 1);
  EXPECT_TRUE(contains(worse.errors, "worse.yaml:2:")) << worse.errors;
  EXPECT_EQ(json({"switch", "--network", "worse.yaml", "--dry-run"}, 1).find("outcome")->as_string(),
            "refused");
  write("large.yaml", "network: large\ntasks: {}\n" + std::string(std::size_t{5} << 20, '#') + "\n");
  const auto large = segue({"switch", "--network", "large.yaml"});
  EXPECT_EQ(large.status, 1);
  EXPECT_TRUE(contains(large.errors, "too large to be sent; at most 4 MiB are")) << large.errors;
  EXPECT_EQ(segue({"switch", "--network", "none.yaml"}).status, 1);
  EXPECT_EQ(segue({"switch", "--network", "bad.yaml", "explore"}).status, 2);
  EXPECT_EQ(text_of_status("controller"), "explore");
}

}  // namespace
}  // namespace segue::testing

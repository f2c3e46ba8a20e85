// SPDX-License-Identifier: Apache-2.0
// What missions did, in the journal of the robot that they commanded.
#include <segue/control/server.hpp>

#include <gmock/gmock.h>

#include <algorithm>

#include "system_test.hpp"

namespace segue::testing {
namespace {

using ::testing::Contains;
using ::testing::ContainsRegex;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Uses two controllers, one after the other, and says why the second action aborts.
constexpr const char* kTour = R"(mission: tour
actions:
  drive_to:
    run:
      controller: go_to
      set: {seeker.speed: 2.0}
      call: {seeker.set_goal: {goal: {x: 0.2, y: 0.0}}}
      until: [{task: seeker, state: arrived}, {after: 5min}]
  give_up:
    run: {controller: explore, until: [{after: 50ms, outcome: aborted}], afterwards: stop}
outcomes: [done]
start: there
states:
  there: {action: drive_to, on: {success: look}}
  look: {action: give_up, on: {aborted: return done, success: return aborted}}
)";

/// Drives to where it never arrives.
constexpr const char* kFar = R"(mission: far
actions:
  drive_to:
    run:
      controller: go_to
      call: {seeker.set_goal: {goal: {x: 1000.0, y: 0.0}}}
      until: [{task: seeker, state: arrived}]
action: drive_to
)";

constexpr const char* kScripted = R"(mission: scripted
actions:
  visit: {controllers: [explore], run: {python: visit.py}}
action: visit
)";
constexpr const char* kVisit = R"(def execute(self, inputs, outputs, gvm):
    self.robot.request("explore")
    return "success"
)";

/// Waits until the rover moves, and then needs a controller whose task takes long to configure.
constexpr const char* kWork = R"(mission: work
actions:
  wait:
    outcomes: [moving]
    run:
      controller: drive_only
      until: [{port: drive.velocity, where: 'forward > 0.1', outcome: moving}, {after: 5min, outcome: aborted}]
  work: {run: {controller: work}}
outcomes: [done]
start: wait
states:
  wait: {on: {moving: work}}
  work: {on: {success: return done}}
)";
constexpr const char* kDriveOnly = R"(network: drive_only
tasks: {drive: {component: "demo::Drive", properties: {timeout: 300s}}}
)";
constexpr const char* kWorking = R"(network: work
tasks:
  drive: {component: "demo::Drive", properties: {timeout: 300s}}
  arm: {component: "x::Arm", properties: {stand_in: {configure: 300ms}}}
)";

class MissionHistory : public SystemTest {
 protected:
  /// "began tour/there", "asked tour/there go_to", "transition -> go_to by mission tour/there".
  static std::string line_of(const type::Value& entry) {
    const auto text = [&](const char* key) {
      const auto* found = entry.find(key);
      return found == nullptr ? std::string() : found->as_string();
    };
    if (text("kind") == "transition") return "transition -> " + text("to") + " by " + text("who");
    std::string line = text("kind") + " " + text("mission");
    line += text("action").empty() ? "" : "/" + text("action");
    for (const char* key : {"controller", "outcome"})
      line += text(key).empty() ? "" : " " + text(key);
    return line;
  }

  /// Once the journal has `last`, since the runtime writes it in the background.
  std::vector<std::string> history_until(const std::string& last) {
    std::vector<std::string> lines;
    const bool has_come = eventually([&] {
      lines.clear();
      const auto history = json({"history", "--missions"});
      for (const auto& entry : history.as_list())
        lines.push_back(line_of(entry));
      return std::ranges::find(lines, last) != lines.end();
    });
    EXPECT_TRUE(has_come) << last << " is not among " << ::testing::PrintToString(lines);
    return lines;
  }

  /// What lies ahead is prepared then.
  void wait_until_ready(const std::string& controller) {
    ASSERT_TRUE(eventually([&] {
      const auto status = json({"status"});
      return std::ranges::any_of(status.find("ready")->as_list(), [&](const auto& one) {
        return one.find("controller")->as_string() == controller && one.find("ready")->as_bool();
      });
    })) << controller
        << " is not prepared: " << segue({"status"}).output;
  }

  static std::unique_ptr<Process> begin(const std::string& file, const std::filesystem::path& folder,
                                        const std::string& mode = "sequential") {
    auto mission =
        std::make_unique<Process>(command({"mission", "run", file, "--follow", "--mode", mode}), folder);
    EXPECT_TRUE(mission->wait_for("began"));
    return mission;
  }
};

TEST_F(MissionHistory, ShowsInOneOrderWhatTheRobotDid) {
  start();
  write("tour.yaml", kTour);
  const auto run = json({"mission", "run", "tour.yaml", "--look-ahead", "0"});
  EXPECT_EQ(run.find("outcome")->as_string(), "done") << type::to_json(run);
  EXPECT_EQ(run.find("look_ahead")->find("transitions")->as_int(), 0) << "it is turned off";
  const auto lines = history_until("ended tour done");
  EXPECT_THAT(
      lines,
      ElementsAre("began tour", "began tour/there", "asked tour/there go_to",
                  "transition -> go_to by mission tour/there", "ended tour/there success", "began tour/look",
                  "asked tour/look explore", "transition -> explore by mission tour/look",
                  "transition ->  by mission tour/look", "ended tour/look aborted", "ended tour done"));
  const auto text = segue({"history", "--missions", "-n", "3"});
  EXPECT_EQ(std::ranges::count(text.output, '\n'), 3) << text.output;
  EXPECT_THAT(text.output, HasSubstr("explore -> empty: done"));
  EXPECT_THAT(text.output, HasSubstr("; requested by mission tour/look"));
  EXPECT_THAT(text.output, HasSubstr("tour/look ended: aborted after "));
  EXPECT_THAT(text.output, HasSubstr("; it had not ended after 50ms"));
  EXPECT_THAT(text.output, HasSubstr("tour ended: done after "));
  EXPECT_EQ(json({"history"}).as_list().size(), 3U) << "requests only";
  EXPECT_EQ(segue({"history", "--missions", "--versions"}).status, 2);
}

TEST_F(MissionHistory, HasWhoAskedForARunAndHow) {
  start();
  write("idle.yaml",
        "mission: idle\nstart: a\nactions: {a: {run: {simulated: {duration: 1ms}}}}\n"
        "states: {a: {on: {success: return success}}}\n");
  EXPECT_EQ(segue({"mission", "run", "idle.yaml"}).status, 0) << "the robot hears nothing of it";
  EXPECT_EQ(segue({"mission", "run", "idle.yaml", "--mode", "concurrent", "--through-robot", "--for", "ann"})
                .status,
            0);
  EXPECT_THAT(history_until("ended idle success"),
              ElementsAre("began idle", "began idle/a", "ended idle/a success", "ended idle success"));
  const auto began = json({"history", "--missions"}).as_list().front();
  EXPECT_THAT(began.find("who")->as_string(), HasSubstr("segue mission run for ann (pid "));
  EXPECT_EQ(began.find("mode")->as_string(), "concurrent");
}

TEST_F(MissionHistory, IsThatOfConcurrentRunsAndScriptsToo) {
  start();
  write("tour.yaml", kTour);
  EXPECT_EQ(segue({"mission", "run", "tour.yaml", "--mode", "concurrent"}).status, 0);
  const auto lines = history_until("ended tour done");
  for (const char* line :
       {"began tour", "began tour/there", "asked tour/there go_to",
        "transition -> go_to by mission tour/there", "ended tour/there success", "asked tour/look explore",
        "transition -> explore by mission tour/look", "ended tour/look aborted"})
    EXPECT_THAT(lines, Contains(line));
  write("scripted.yaml", kScripted);
  write("visit.py", kVisit);
  const auto scripted = segue({"mission", "run", "scripted.yaml"});
  EXPECT_EQ(scripted.status, 0) << scripted.output << scripted.errors;
  EXPECT_THAT(history_until("ended scripted success"), Contains("asked scripted explore"));
}

TEST_F(MissionHistory, SaysThatAMissionWasKilledOrLostTheRobot) {
  start();
  write("far.yaml", kFar);
  auto killed = begin("far.yaml", folder_);
  wait_for_controller("go_to");
  (void)history_until("asked far go_to");
  killed->signal(SIGKILL);
  (void)killed->wait();
  (void)history_until("ended far lost");
  EXPECT_THAT(segue({"history", "--missions"}).output, HasSubstr("whoever ran it gave the robot back"));

  std::string again = kFar;
  again.replace(again.find("far"), 3, "beyond");
  write("beyond.yaml", again);
  auto taken = begin("beyond.yaml", folder_);
  (void)history_until("asked beyond go_to");
  EXPECT_EQ(segue({"switch", "explore", "--take-over"}).status, 0);
  EXPECT_NE(taken->wait().status, 0);
  (void)history_until("ended beyond lost");
  const std::string text = segue({"history", "--missions"}).output;
  EXPECT_THAT(text, HasSubstr("beyond ended: lost after "));
  EXPECT_THAT(text, HasSubstr("the robot was taken over by segue switch"));
}

TEST_F(MissionHistory, SaysWhatLookAheadSaved) {
  ASSERT_EQ(segue({"init", "rover"}).status, 0);
  write("rover/controllers/drive_only.yaml", kDriveOnly);
  write("rover/controllers/work.yaml", kWorking);
  start({"--stand-in"});
  write("work.yaml", kWork);
  auto working = begin("work.yaml", folder_);
  ASSERT_NO_FATAL_FAILURE(wait_until_ready("work"));
  EXPECT_EQ(segue({"write", "drive.command={forward: 0.3, turn: 0.0}", "--beside-mission"}).status, 0);
  const auto ended = working->wait();
  EXPECT_EQ(ended.status, 0) << ended.output << ended.errors;
  EXPECT_THAT(ended.output, ContainsRegex("Look-ahead saved [0-9.]+ m?s of 1 transition\\."));
  (void)history_until("ended work done");
  EXPECT_THAT(segue({"history"}).output,
              ContainsRegex("-> drive_only\\+work: done.*; look-ahead saved .* \\(1 task was ready\\)"));
  EXPECT_THAT(segue({"history", "--missions"}).output, HasSubstr("; look-ahead saved "));
  const auto history = json({"history", "--all"});
  std::vector<double> saved;
  for (const auto& entry : history.as_list()) {
    const auto* ahead = entry.find("ahead");
    if (ahead == nullptr) continue;
    EXPECT_EQ(entry.find("to")->as_string(), "drive_only+work");
    EXPECT_EQ(ahead->find("tasks")->as_int(), 1);
    EXPECT_GE(ahead->find("unprepared_s")->as_double(), 0.3);
    saved.push_back(ahead->find("saved_s")->as_double());
  }
  ASSERT_EQ(saved.size(), 1U);
  EXPECT_GT(saved.front(), 0.0);
}

TEST_F(MissionHistory, AMissionTellsItsPlanWhenSomebodyLooks) {
  start({"--no-journal"});
  std::string text = kTour;
  text.replace(text.find("x: 0.2"), 6, "x: 900.0");
  write("tour.yaml", text);
  const auto mission = begin("tour.yaml", folder_, "concurrent");
  const auto robot = control::connect(control::socket_path("rover").value());
  ASSERT_TRUE(robot) << to_string(robot.error());
  type::Value shown;
  ASSERT_TRUE(eventually([&] {
    shown = (*robot)->mission(0, true).value();
    return !shown.is_null() && shown.find("plan")->is_map() && shown.find("plan")->find("outline") == nullptr;
  })) << type::to_json(shown);
  const type::Value& plan = *shown.find("plan");
  EXPECT_EQ(plan.find("states")->as_list().size(), 3U) << type::to_json(plan);
  const auto& look = plan.find("nodes")->as_list().at(1);
  EXPECT_EQ(look.find("name")->as_string(), "look");
  const auto& after = look.find("after")->as_list().at(0);
  EXPECT_EQ(after.find("node")->as_uint(), 0U);
  EXPECT_NE(after.find("because")->as_string(), "");
  EXPECT_EQ(shown.find("state")->as_string(), "running");
  const auto status = (*robot)->status().value();
  EXPECT_EQ(status.find("doing")->find("plan"), nullptr) << "which stays small";
}

TEST_F(MissionHistory, AMissionAtWhichNobodyLookedCanBeShownWhenItHasEnded) {
  start({"--no-journal"});
  write("tour.yaml", kTour);
  for (const char* mode : {"sequential", "concurrent"}) {
    ASSERT_EQ(segue({"mission", "run", "tour.yaml", "--mode", mode}).status, 0);
    const auto robot = control::connect(control::socket_path("rover").value());
    ASSERT_TRUE(robot) << to_string(robot.error());
    const type::Value shown = (*robot)->mission(0, true).value();
    EXPECT_EQ(shown.find("state")->as_string(), "ended");
    ASSERT_TRUE(shown.find("plan")->is_map()) << type::to_json(shown);
    EXPECT_EQ(shown.find("plan")->find("states")->as_list().size(), 3U);
  }
}

TEST_F(MissionHistory, ARobotNeedsNoJournalForAMission) {
  start({"--no-journal"});
  write("tour.yaml", kTour);
  EXPECT_EQ(segue({"mission", "run", "tour.yaml"}).status, 0);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "state"));
}

TEST_F(MissionHistory, AMissionOutlivesAJournalThatCannotBeWritten) {
  write("in_the_way", "a file where a folder should be");
  start({"--journal", "in_the_way/journal.sqlite"});
  write("tour.yaml", kTour);
  const auto run = segue({"mission", "run", "tour.yaml"});
  EXPECT_EQ(run.status, 0) << run.output << run.errors;
  EXPECT_THAT(segue({"events"}).output, HasSubstr("cannot be written"));
}

}  // namespace
}  // namespace segue::testing

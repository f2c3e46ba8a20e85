// SPDX-License-Identifier: Apache-2.0
// Verbs that look around in a running robot: hz, bw, delay, graph, types, doctor; and restart.
#include <gmock/gmock.h>

#include <algorithm>
#include <functional>
#include <regex>
#include <set>
#include <sstream>

#include "system_test.hpp"

namespace segue::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;
using type::Value;

class Looking : public SystemTest {
 protected:
  void SetUp() override {
    SystemTest::SetUp();
    start({"--controller", "explore"});
    ASSERT_NO_FATAL_FAILURE(wait_for_controller("explore"));
  }
  std::string error_of(std::vector<std::string> arguments) {
    const auto finished = segue(std::move(arguments));
    EXPECT_EQ(finished.status, 1) << finished.output;
    return finished.errors;
  }
};

TEST_F(Looking, MeasuresHowOftenPortsAreWritten) {
  const auto one = segue({"hz", "odometry.pose", "-n", "2", "--every", "300ms", "--format", "json"});
  ASSERT_EQ(one.status, 0) << one.errors;
  std::istringstream lines(one.output);
  int reports = 0;
  for (std::string line; std::getline(lines, line); ++reports) {
    const auto measured = type::parse_json(line);
    ASSERT_TRUE(measured) << line;
    EXPECT_EQ(measured->find("port")->as_string(), "odometry.pose");
    EXPECT_GT(measured->find("samples")->as_int(), 0);
    EXPECT_GT(measured->find("bytes")->as_int(), 0);
  }
  EXPECT_EQ(reports, 2);
  const auto all = segue({"hz", "drive", "laser.scan", "-n", "1"});
  EXPECT_THAT(all.output, HasSubstr("drive.velocity  "));
  EXPECT_THAT(all.output, HasSubstr("laser.scan      "));
  EXPECT_THAT(all.output, HasSubstr(" Hz, period "));
  EXPECT_THAT(segue({"bw", "laser.scan", "-n", "1"}).output, HasSubstr("B/s, "));
}

TEST_F(Looking, SaysWhereNothingIsWritten) {
  write("idle.yaml", "network: idle\ntasks: {laser: {component: \"demo::LaserScanner\", state: stopped}}\n");
  ASSERT_EQ(segue({"switch", "--network", "idle.yaml"}).status, 0);
  EXPECT_THAT(segue({"hz", "laser.scan", "-n", "1", "--every", "100ms"}).output,
              HasSubstr("laser.scan  nothing is written"));
  EXPECT_THAT(json({"restart", "laser"}).find("actions")->as_list(), SizeIs(2)) << "it stays stopped";
  EXPECT_THAT(error_of({"hz", "lasr"}), HasSubstr("lasr: the robot has no such task, did you mean 'laser'?"));
  EXPECT_THAT(error_of({"bw", "laser.scam"}), HasSubstr("did you mean 'scan'?"));
}

TEST_F(Looking, ShowsTheDelaysOfAPort) {
  EXPECT_TRUE(eventually([&] {
    const auto delays = json({"delay", "laser.scan"});
    return delays.as_list().size() == 1 && delays.as_list()[0].find("measured")->as_int() > 0;
  }));
  EXPECT_EQ(json({"delay", "drive"}).as_list().size(), 2U);
  EXPECT_THAT(segue({"delay", "laser"}).output, HasSubstr("99 % WITHIN"));
  EXPECT_THAT(error_of({"delay", "laser.scam"}), HasSubstr("did you mean 'laser.scan'?"));
}

TEST_F(Looking, DrawsWhoIsConnectedWithWhom) {
  const std::string text = segue({"graph"}).output;
  EXPECT_THAT(text, HasSubstr("laser  demo::LaserScanner, running\n  scan -> wanderer.scan\n"));
  const auto at = [&](const char* task) { return text.find(task + std::string("  demo::")); };
  EXPECT_LT(at("drive"), at("odometry")) << "of the loop the first, then along the connections";
  EXPECT_LT(at("odometry"), at("laser"));
  EXPECT_LT(at("laser"), at("wanderer"));
  const std::string dot = segue({"graph", "--dot"}).output;
  EXPECT_THAT(dot, HasSubstr("digraph network {"));
  EXPECT_THAT(dot, HasSubstr("\"laser\" -> \"wanderer\" [label=\"scan -> scan\"];"));
  EXPECT_THAT(segue({"graph", "--svg"}).output,
              AllOf(HasSubstr("<svg"), HasSubstr("laser.scan -&gt; wanderer.scan")));
  const Value running = json({"graph"});
  const Value file = json({"graph", "rover/controllers/explore.yaml"});
  EXPECT_EQ(running.find("connections")->as_list().size(), 4U);
  EXPECT_EQ(file.find("connections")->as_list().size(), 4U);
  EXPECT_EQ(file.find("tasks")->as_list().size(), running.find("tasks")->as_list().size());
  EXPECT_EQ(segue({"graph", "no_file.yaml"}).status, 1);
  write("lone.yaml", "network: lone\ntasks: {wanderer: {component: demo::Wanderer}}\n");
  EXPECT_THAT(segue({"graph", "lone.yaml"}).output, HasSubstr("  nothing writes to "));
}

TEST_F(Looking, ShowsTypesAndThePortsThatHaveThem) {
  EXPECT_THAT(segue({"types"}).output, HasSubstr("demo::Scan"));
  const Value scan = json({"types", "Scan"});
  EXPECT_EQ(scan.find("name")->as_string(), "/demo/Scan");
  EXPECT_FALSE(scan.find("ports")->as_list().empty());
  EXPECT_THAT(segue({"types", "demo::Scan"}).output, HasSubstr("demo::LaserScanner"));
  EXPECT_THAT(error_of({"types", "Scam"}), HasSubstr("did you mean 'Scan'?"));
}

TEST_F(Looking, NoLineOfATableIsWiderThanTheTerminal) {
  const auto widest = [](const std::string& text) {
    static const std::regex colours("\x1b\\[[0-9]*m|\r");
    std::istringstream lines(std::regex_replace(text, colours, ""));
    std::size_t most = 0;
    for (std::string line; std::getline(lines, line);)
      most = std::max(most, line.size());
    return most;
  };
  for (const std::vector<std::string>& verb :
       {std::vector<std::string>{"types"}, {"component", "list"}, {"component", "show", "demo::Drive"}}) {
    EXPECT_GT(widest(segue(verb).output), 100U) << verb.back() << ": into a pipe as wide as it is";
    const auto shown = run_on_terminal(command(verb), folder_);
    EXPECT_EQ(shown.status, 0);
    EXPECT_LE(widest(shown.output), 100U) << shown.output;
  }
}

/// A terminal of 80 columns and few rows on which `typed` is typed when the first page is there.
Terminal small_terminal(const std::string& typed) {
  return {.columns = 80, .rows = 8, .typed = typed, .typed_after = "q quits"};
}

TEST_F(Looking, TopShowsWhatFitsOnTheTerminalUntilQIsTyped) {
  const auto shown = run_on_terminal(command({"top", "--sort", "name"}), folder_, small_terminal("q"));
  EXPECT_EQ(shown.status, 0);
  const auto page = shown.output.substr(0, shown.output.find("q quits"));
  EXPECT_LE(std::ranges::count(page, '\n'), 6) << page;
  EXPECT_THAT(page, AllOf(HasSubstr("explore, idle; up"), HasSubstr("drive  "), HasSubstr("... 3 more"),
                          Not(HasSubstr("wanderer "))));
}

TEST_F(Looking, TopLeavesTheTerminalAsItWas) {
  for (const std::string typed : {"q", "\x03"}) {
    const auto shell =
        run_on_terminal({"/bin/sh", "-c",
                         "trap : INT; '" + std::string(segue::paths::kProgram) + "' top; stty -a; echo done"},
                        folder_, small_terminal(typed));
    EXPECT_THAT(shell.output, AllOf(HasSubstr(" icanon"), HasSubstr(" echo "), HasSubstr("done"))) << typed;
  }
}

TEST_F(Looking, TopSortsTasks) {
  const auto order = [&](const std::string& key) {
    std::vector<double> numbers;
    const Value status = json({"top", "--once", "--sort", key});
    for (const Value& task : status.find("tasks")->as_list())
      numbers.push_back(task.find(key + "_us")->as_double());
    return numbers;
  };
  for (const std::string key : {"cpu", "worst", "latency"}) {
    const auto numbers = order(key);
    EXPECT_THAT(numbers, SizeIs(4));
    EXPECT_TRUE(std::ranges::is_sorted(numbers, std::ranges::greater())) << key;
  }
}

TEST_F(Looking, PlotsNumbersOfSamples) {
  const auto drawn = run_on_terminal(command({"plot", "odometry.pose.x", "laser.scan", "-n", "20"}), folder_);
  EXPECT_EQ(drawn.status, 1);
  EXPECT_THAT(drawn.output, HasSubstr("fields of one port are plotted at once"));
  const auto picture =
      run_on_terminal(command({"plot", "odometry.pose.x", "odometry.pose.y", "-n", "20"}), folder_);
  EXPECT_EQ(picture.status, 0);
  EXPECT_THAT(picture.output,
              AllOf(HasSubstr("x: "), HasSubstr("y: "), HasSubstr("0.0 s"), HasSubstr("\xe2")));
  EXPECT_THAT(run_on_terminal(command({"plot", "laser.scan", "-n", "1"}), folder_).output,
              AllOf(HasSubstr("ranges[0]: "), HasSubstr(" more fields")));
  std::istringstream lines(segue({"plot", "laser.scan.ranges[3]", "-n", "5", "--format", "json"}).output);
  double last = -1;
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    const auto sample = type::parse_json(line);
    ASSERT_TRUE(sample) << line;
    EXPECT_GT(sample->find("time_s")->as_double(), last);
    last = sample->find("time_s")->as_double();
    EXPECT_GT(sample->find("fields")->find("ranges[3]")->as_double(), 0) << line;
  }
  EXPECT_EQ(count, 5);
  EXPECT_THAT(segue({"plot", "odometry.pose", "-n", "1"}).output,
              AllOf(HasSubstr("  x: "), HasSubstr("  theta: ")));
}

TEST_F(Looking, SaysWhatCanBePlotted) {
  EXPECT_THAT(error_of({"plot", "odometry.pose.z"}),
              HasSubstr("odometry.pose: its sample has no number 'z'; it has: x, y and theta"));
  EXPECT_THAT(error_of({"plot", "odometry.pos.x"}), HasSubstr("no output port 'pos', did you mean 'pose'?"));
  EXPECT_THAT(error_of({"plot", "odometry.pose.x["}), HasSubstr("'x[' is not a field such as"));
}

TEST_F(Looking, RestartsTasks) {
  const auto configured = [&](const Value& report) {
    std::multiset<std::string> actions;
    for (const auto& action : report.find("actions")->as_list())
      actions.insert(action.find("kind")->as_string() + " " + action.find("task")->as_string());
    return actions;
  };
  EXPECT_EQ(configured(json({"restart", "laser"})),
            (std::multiset<std::string>{"stop laser", "cleanup laser", "configure laser", "start laser"}));
  EXPECT_EQ(controller(), "explore");
  EXPECT_THAT(segue({"status"}).output, HasSubstr("controller explore, idle"));
  EXPECT_EQ(configured(json({"restart", "laser", "drive"})).size(), 8U);
  ASSERT_EQ(segue({"switch", "explore+hold"}).status, 0);
  EXPECT_EQ(segue({"restart", "laser"}).status, 0);
  EXPECT_EQ(controller(), "explore+hold");
  write("stop.yaml", "transition: {actions: [{id: 1, kind: stop, task: laser}]}\n");
  ASSERT_EQ(segue({"switch", "--transition", "stop.yaml"}).status, 0);
  EXPECT_EQ(controller(), "");
  EXPECT_EQ(segue({"restart", "laser", "odometry"}).status, 0) << "of a network without a name";
  EXPECT_THAT(error_of({"restart", "lasr"}),
              HasSubstr("lasr: the robot has no such task, did you mean 'laser'?"));
}

TEST_F(Looking, RestartsNothingOfARobotThatSomebodyElseCommands) {
  write("wait.yaml",
        "mission: wait\nactions: {stay: {run: {controller: explore, until: [{after: 1h}]}}}\n"
        "start: stay\nstates: {stay: {on: {success: return success}}}\n");
  Process mission(command({"mission", "run", "wait.yaml"}), folder_);
  ASSERT_TRUE(eventually([&] { return mission.has_ended() || segue({"mission", "status"}).status == 0; }));
  ASSERT_FALSE(mission.has_ended());
  EXPECT_THAT(error_of({"restart", "laser"}), HasSubstr("segue mission run"));
  EXPECT_EQ(segue({"restart", "laser", "--take-over"}).status, 0);
  EXPECT_NE(mission.wait().status, 0);
}

TEST_F(Looking, MergesTheOutputOfAllProcesses) {
  EXPECT_THAT(error_of({"log"}), HasSubstr("there is no output of any process"));
  write("apart.yaml",
        "network: apart\ntasks:\n  drive: {component: \"demo::Drive\"}\n"
        "  laser: {component: \"demo::LaserScanner\"}\n"
        "deployments: {base: {tasks: [drive]}, eyes: {tasks: [laser]}}\n");
  ASSERT_EQ(segue({"switch", "--network", "apart.yaml"}).status, 0);
  const auto all = segue({"log"});
  EXPECT_THAT(all.output, AllOf(HasSubstr("base | "), HasSubstr("\neyes | ")));
  EXPECT_THAT(segue({"log", "eyes"}).output, Not(HasSubstr(" | ")));
  Process follower(command({"log", "-f"}), folder_);
  EXPECT_TRUE(follower.wait_for("eyes | "));
  ASSERT_EQ(segue({"switch", "empty"}).status, 0);
  ASSERT_EQ(segue({"switch", "--network", "apart.yaml"}).status, 0);
  const auto lines = [](const std::string& output, const std::string& begin) {
    std::size_t count = 0;
    for (auto at = output.find(begin); at != std::string::npos; at = output.find(begin, at + 1))
      ++count;
    return count;
  };
  EXPECT_TRUE(follower.wait_until([&](const std::string& output) {
    return lines(output, "base | ") > lines(all.output, "base | ") &&
           lines(output, "eyes | ") > lines(all.output, "eyes | ");
  }));
  EXPECT_THAT(error_of({"log", "eys"}), HasSubstr("did you mean 'eyes'?"));
}

class Doctor : public SystemTest {
 protected:
  Value finding(const std::string& check, int status) {
    const Value findings = json({"doctor"}, status);
    for (const Value& found : findings.as_list()) {
      if (found.find("check")->as_string() == check) return found;
    }
    return Value::map({{"health", "none"}, {"what", "none"}, {"mend", "none"}});
  }
  static std::string text(const Value& found, const char* key) { return found.find(key)->as_string(); }
};

TEST_F(Doctor, FindsRobotsAndWhatTheyLack) {
  start();
  EXPECT_EQ(text(finding("robot rover", 0), "what"), "healthy");
  EXPECT_THAT(text(finding("component libraries", 0), "what"), HasSubstr(" components"));
  EXPECT_THAT(segue({"doctor"}).output, HasSubstr("good    robot rover: healthy"));
}

TEST_F(Doctor, FindsProcessesWhoseRuntimeIsGone) {
  ASSERT_EQ(segue({"init", "rover"}).status, 0);
  write("rover/controllers/apart.yaml",
        "network: apart\ntasks: {drive: {component: \"demo::Drive\"}}\ndeployments: {base: {tasks: "
        "[drive]}}\n");
  start({"--controller", "apart"});
  ASSERT_NO_FATAL_FAILURE(wait_for_controller("apart"));
  robot_->signal(SIGKILL);
  robot_->wait();
  const Value left = finding("processes left over", 1);
  EXPECT_EQ(text(left, "health"), "bad");
  EXPECT_EQ(text(left, "what"), "base of robot rover runs without its runtime");
  start();
  EXPECT_EQ(text(finding("processes left over", 0), "health"), "none") << "they have been adopted";
}

TEST_F(Doctor, FindsLibrariesThatCannotBeLoaded) {
  write("libraries/libbroken.so", "no library");
  ::setenv("SEGUE_LIBRARY_PATH", (folder_ / "libraries").c_str(), 1);
  const Value found = finding("component libraries", 1);
  EXPECT_EQ(text(found, "health"), "bad");
  EXPECT_THAT(text(found, "what"), HasSubstr("broken.components.yaml"));
  ::unsetenv("SEGUE_LIBRARY_PATH");
}

TEST_F(Doctor, FindsAFolderOfSocketsThatIsNotOurs) {
  write("no_folder", "");
  ::setenv("XDG_RUNTIME_DIR", (folder_ / "no_folder").c_str(), 1);
  EXPECT_EQ(text(finding("folder of sockets", 1), "health"), "bad");
  ::setenv("XDG_RUNTIME_DIR", (folder_ / "runtime").c_str(), 1);
}

}  // namespace
}  // namespace segue::testing

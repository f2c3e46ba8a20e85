// SPDX-License-Identifier: Apache-2.0
// Verbs that look around in a running robot: hz, bw, delay; and restart.
#include <gmock/gmock.h>

#include <set>
#include <sstream>

#include "system_test.hpp"

namespace segue::testing {
namespace {

using ::testing::HasSubstr;
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

}  // namespace
}  // namespace segue::testing

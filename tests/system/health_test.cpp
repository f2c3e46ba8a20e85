// SPDX-License-Identifier: Apache-2.0
//
// What the command says of a robot that lacks something, and how it is repaired.
#include "system_test.hpp"

#include <sys/types.h>

#include <csignal>
#include <string>
#include <vector>

namespace segue::testing {
namespace {

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Its laser has a process of its own; what fails is left so.
class HalfDeadRobot : public SystemTest {
 protected:
  void SetUp() override {
    SystemTest::SetUp();
    write("rover/robot.yaml",
          "robot: rover\ncontrollers: [\"*.net\"]\npolicies: {on_failure: report, watch: 50ms}\n");
    write("rover/drive.net",
          "network: drive\ntasks:\n  base: {component: \"x::Base\"}\n  laser: {component: \"x::Laser\"}\n"
          "deployments: {sensors: {tasks: [laser]}}\nconnections: [laser.scan -> base.scan]\n");
    start({"--stand-in", "--controller", "drive"});
    wait_for_controller("drive");
    ASSERT_TRUE(eventually([&] { return health() == 0; }));
  }
  int health() { return segue({"status", "--exit-code"}).status; }
  void signal_laser(int signal) {
    const auto status = json({"status"});
    for (const auto& task : status.find("tasks")->as_list()) {
      if (task.find("id")->as_string() != "laser") continue;
      ASSERT_EQ(::kill(static_cast<pid_t>(task.find("pid")->as_int()), signal), 0);
    }
  }
};

TEST_F(HalfDeadRobot, SaysWhatIsMissingAndIsRepairedOnRequest) {
  signal_laser(SIGKILL);
  ASSERT_TRUE(eventually([&] { return health() == 5; }));
  EXPECT_TRUE(eventually([&] { return has(segue({"status"}).output, "SIGKILL"); }))
      << "why is known a moment later";
  const auto status = segue({"status"});
  EXPECT_EQ(status.status, 0) << "without --exit-code";
  EXPECT_FALSE(has(status.output, "idle")) << status.output;
  for (const char* part : {"in trouble", "trouble: process 'localhost/sensors' is gone, since", "SIGKILL",
                           "repair: `segue repair` repairs it"}) {
    EXPECT_TRUE(has(status.output, part)) << part << " in " << status.output;
  }
  const auto top = segue({"top", "--once"});
  EXPECT_TRUE(has(top.output, "in trouble")) << top.output;
  const auto repaired = segue({"repair"});
  EXPECT_EQ(repaired.status, 0) << repaired.errors;
  EXPECT_TRUE(eventually([&] { return health() == 0; }));
  stop();
  EXPECT_EQ(health(), 3);
}

TEST_F(HalfDeadRobot, NamesTheProcessThatDoesNotAnswer) {
  signal_laser(SIGSTOP);
  ASSERT_TRUE(eventually([&] { return health() == 5; }));
  for (const auto& arguments :
       {std::vector<std::string>{"task", "laser"}, std::vector<std::string>{"set", "laser.gain=1"},
        std::vector<std::string>{"call", "laser.reset"}}) {
    const auto refused = segue(arguments);
    EXPECT_NE(refused.status, 0);
    EXPECT_TRUE(has(refused.errors, "process 'localhost/sensors'") && has(refused.errors, "does not answer"))
        << refused.errors;
  }
  const auto repaired = segue({"repair"});
  EXPECT_EQ(repaired.status, 0) << repaired.errors;
  EXPECT_TRUE(eventually([&] { return health() == 0; }));
}

}  // namespace
}  // namespace segue::testing

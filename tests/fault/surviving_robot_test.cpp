// SPDX-License-Identifier: Apache-2.0
// Through the real command line: the robot survives the death of the runtime and of the process server.
#include "fault_test.hpp"

namespace segue::testing {
namespace {

using type::Value;

class SurvivingRobot : public FaultTest {
 protected:
  void SetUp() override {
    FaultTest::SetUp();
    write_network("plain");
    write_network("working", "  relay: {component: \"fault::Relay\"}\n", "  work: {tasks: [relay]}\n",
                  "  - {from: beater.out, to: relay.in, policy: buffer, size: 100}\n");
  }
  /// Tasks and their processes, without those of the runtime's own process.
  std::string status_of_deployments() {
    std::string text;
    const auto status = json({"status"});
    for (const Value& task : status.find("tasks")->as_list()) {
      if (task.find("process")->as_string().empty()) continue;
      for (const char* key : {"id", "component", "state", "process", "pid"})
        text += type::to_json(*task.find(key)) + ' ';
      text += '\n';
    }
    return text;
  }
};

TEST_F(SurvivingRobot, ItsRuntimeIsKilledAndStartedAgain) {
  start("working");
  expect_undisturbed();
  const auto before = deployments();
  EXPECT_EQ(before.size(), 3U);
  const std::string status = status_of_deployments();
  for (int i = 0; i < 3; ++i) {
    kill_runtime();
    EXPECT_EQ(deployments(), before) << "they outlive their runtime";
    start("");
    EXPECT_EQ(status_of_deployments(), status);
    expect_undisturbed();
  }
  switch_to("working");
  EXPECT_EQ(what_is_wrong("working"), "");
  EXPECT_EQ(deployments(), before);
  expect_undisturbed();
  expect_undisturbed("witness");
  switch_to("plain");
  expect_deployments({"eye", "heart"});
  expect_undisturbed();
}

TEST_F(SurvivingRobot, ItsRuntimeIsKilledInASwitch) {
  start("plain");
  for (const char* at :
       {"deploy localhost/work", "apply_config relay", "configure relay", "connect", "start relay"}) {
    SCOPED_TRACE(at);
    switch_to("plain");
    const auto numbers = json({"events"});
    const auto last = numbers.as_list().back().find("number")->as_int();
    Process follower(command({"events", "--follow", "--after", std::to_string(last)}), folder_);
    Process switcher(command({"switch", "working"}), folder_);
    EXPECT_TRUE(follower.wait_for(at));
    kill_runtime();
    follower.wait();
    switcher.wait();
    start("");
    EXPECT_TRUE(recover_to("working")) << what_is_wrong("working");
    expect_undisturbed();
  }
}

TEST_F(SurvivingRobot, AKilledDeploymentIsReportedAndReplaced) {
  start("working");
  const auto before = deployments();
  for (const char* victim : {"work", "heart", "eye"}) {
    SCOPED_TRACE(victim);
    const pid_t pid = pid_of(victim);
    ::kill(pid, SIGKILL);
    expect_event("process", "SIGKILL");
    EXPECT_NE(segue({"log", victim}).output.find("SIGKILL"), std::string::npos);
    EXPECT_TRUE(recover_to("working")) << what_is_wrong("working");
    EXPECT_NE(pid_of(victim), pid);
    EXPECT_TRUE(eventually([&] { return json({"status"}).find("ended")->as_list().empty(); }));
    EXPECT_EQ(sight().torn, 0U);
  }
  EXPECT_EQ(deployments().size(), 3U);
}

TEST_F(SurvivingRobot, ItsProcessServerIsKilled) {
  Process daemon(command({"host"}), folder_);
  ASSERT_TRUE(eventually([&] { return std::filesystem::exists(folder_ / "runtime/segue/host.sock"); }));
  run_options_ = {"--daemon"};
  start("working");
  const auto before = deployments();
  daemon.signal(SIGKILL);
  daemon.wait();
  EXPECT_EQ(deployments(), before) << "they outlive their process server";
  expect_undisturbed();
  EXPECT_TRUE(what_is_wrong("working").empty()) << what_is_wrong("working");
  Process next(command({"host"}), folder_);
  EXPECT_TRUE(recover_to("plain")) << what_is_wrong("plain");
  expect_deployments({"eye", "heart"});
  EXPECT_TRUE(recover_to("working")) << what_is_wrong("working");
  expect_undisturbed();
  EXPECT_EQ(stop().status, 0);
  next.signal(SIGTERM);
  EXPECT_EQ(next.wait().status, 0);
}

TEST_F(SurvivingRobot, StopsCleanlyAndLeavesNothing) {
  start("working");
  EXPECT_EQ(stop().status, 0);
  EXPECT_TRUE(deployments().empty());
}

}  // namespace
}  // namespace segue::testing

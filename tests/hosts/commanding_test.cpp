// SPDX-License-Identifier: Apache-2.0
// Who commands a robot on several hosts: its runtime is killed, or there are two.
#include <support/eventually.hpp>

#include "chain.hpp"

namespace segue::testing {
namespace {

class CommandingHosts : public ChainTest {
 protected:
  void TearDown() override {
    if (second_) end_second();
    ChainTest::TearDown();
  }

  /// As another user of another computer would: with other folders.
  void start_second(const std::vector<std::string>& options) {
    std::vector<std::string> all = {"--stand-ins", "slow.yaml"};
    all.insert(all.end(), options.begin(), options.end());
    second_ = run_robot("second", all);
  }
  void end_second() {
    second_->signal(SIGINT);
    EXPECT_EQ(second_->wait(), 0) << second_->output();
    second_.reset();
  }
  /// Commands are to this runtime from now on.
  void talk_to(const std::string& runtime_folder) const {
    ::setenv("XDG_RUNTIME_DIR", (folder_ / runtime_folder).c_str(), 1);
  }
  /// The name of what the robot runs.
  std::string controller() { return status().find("controller")->as_string(); }
  /// How leases name it.
  static std::string name_of(const LoggedProcess& runtime) {
    return "/" + std::to_string(runtime.pid()) + "/";
  }

  std::unique_ptr<LoggedProcess> second_;
};

TEST_F(CommandingHosts, ARuntimeThatIsStartedAgainAdoptsWhatRuns) {
  make_chain();
  start_chain("plain");
  expect_flow();
  const auto before = all_deployments();
  for (int i = 0; i < 3; ++i) {
    SCOPED_TRACE(i);
    kill_runtime();
    EXPECT_EQ(all_deployments(), before) << "they outlive their runtime";
    start_chain("");
    EXPECT_EQ(what_stays_wrong(HostsTest::network("plain")), "");
    EXPECT_EQ(all_deployments(), before);
    expect_flow();
    switch_to("more");
    EXPECT_EQ(what_stays_wrong(HostsTest::network("more")), "");
    switch_to("plain");
    EXPECT_EQ(what_stays_wrong(HostsTest::network("plain")), "");
    EXPECT_EQ(all_deployments(), before);
  }
  expect_all_arrived();
}

TEST_F(CommandingHosts, ARuntimeAdoptsWhatRunsOnAHostThatWasAwayWhenItWasStarted) {
  make_chain();
  start_chain("plain");
  expect_flow();
  const auto before = all_deployments();
  kill_runtime();
  host("b").kill_daemon();
  start_chain("");
  ASSERT_TRUE(wait_until_reachable("b", false));
  EXPECT_EQ(controller(), "") << "a part of it names no controller";
  host("b").start();
  ASSERT_TRUE(wait_until_reachable("b", true));
  EXPECT_TRUE(eventually([&] { return controller() == "plain"; }));
  EXPECT_EQ(what_stays_wrong(HostsTest::network("plain")), "");
  EXPECT_EQ(all_deployments(), before);
  expect_flow();
  expect_all_arrived();
}

TEST_F(CommandingHosts, ASecondRuntimeIsRefused) {
  make_chain();
  start_chain("plain");
  const auto before = all_deployments();
  start_second({});
  EXPECT_EQ(second_->wait(), 1);
  const std::string said = second_->output();
  second_.reset();
  EXPECT_NE(said.find(name_of(*runtime_)), std::string::npos) << said;
  EXPECT_NE(said.find("--take-over"), std::string::npos) << said;
  EXPECT_EQ(all_deployments(), before);
  expect_flow();
  expect_all_arrived();
}

TEST_F(CommandingHosts, ASecondRuntimeTakesTheRobotOver) {
  make_chain();
  start_chain("plain");
  expect_flow();
  const auto before = all_deployments();
  start_second({"--take-over"});
  ASSERT_TRUE(second_->wait_for("robot " + robot_name_ + " runs")) << second_->output();
  ASSERT_TRUE(wait_until_reachable("a", false));
  ASSERT_TRUE(wait_until_reachable("b", false));
  const auto state = host_status("a").find("state")->as_string();
  EXPECT_NE(state.find(name_of(*second_)), std::string::npos) << state;
  EXPECT_NE(status().find("lost")->as_string().find(name_of(*second_)), std::string::npos);
  switch_to("more", "refused");
  EXPECT_EQ(all_deployments(), before);

  talk_to("second");
  EXPECT_EQ(what_stays_wrong(HostsTest::network("plain")), "");
  expect_flow();
  switch_to("more");
  EXPECT_EQ(what_stays_wrong(HostsTest::network("more")), "");
  switch_to("plain");
  expect_all_arrived();
  talk_to("runtime");
  runtime_->signal(SIGINT);  // it has nothing to stop any more
  EXPECT_EQ(runtime_->wait(), 1) << runtime_->output();
  EXPECT_NE(runtime_->output().find("another runtime has got the robot"), std::string::npos)
      << runtime_->output();
  runtime_.reset();
  talk_to("second");
  EXPECT_EQ(what_stays_wrong(HostsTest::network("still")), "");
}

TEST_F(CommandingHosts, ARuntimeThatHasLostTheRobotRegainsNoHostWhoseDaemonStartsAgain) {
  make_chain();
  start_chain("plain");
  start_second({"--take-over"});
  ASSERT_TRUE(second_->wait_for("robot " + robot_name_ + " runs")) << second_->output();
  ASSERT_TRUE(wait_until_reachable("a", false));
  talk_to("second");
  host("a").kill_daemon();
  ASSERT_TRUE(wait_until_reachable("a", false));
  host("a").start();
  ASSERT_TRUE(wait_until_reachable("a", true));
  switch_to("more");
  EXPECT_EQ(what_stays_wrong(HostsTest::network("more")), "");
  switch_to("plain");
  talk_to("runtime");
  EXPECT_FALSE(host_status("a").find("reachable")->as_bool());
  switch_to("more", "refused");
  runtime_->signal(SIGINT);
  EXPECT_EQ(runtime_->wait(), 1) << runtime_->output();
  runtime_.reset();
  talk_to("second");
  EXPECT_EQ(what_stays_wrong(HostsTest::network("plain")), "");
}

}  // namespace
}  // namespace segue::testing

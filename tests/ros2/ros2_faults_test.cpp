// SPDX-License-Identifier: Apache-2.0
// Nodes of ROS 2 with faults, on either middleware, which a robot takes over through the real command line:
// each fault is said, and leaves the switch undone or finished.
#include <support/dds_domain.hpp>

#include <gmock/gmock.h>

#include "../../components/ros2/peers/managed_peer.hpp"
#include "../system/system_test.hpp"

#include <string>
#include <vector>

namespace segue::testing {
namespace {

using ::ros2::testing::ManagedPeer;
using ::ros2::testing::Middleware;
using ::ros2::testing::Peer;
using ::testing::HasSubstr;
using Fault = ManagedPeer::Fault;

class FaultyNodes : public SystemTest, public ::testing::WithParamInterface<Middleware> {
 protected:
  void SetUp() override {
    SystemTest::SetUp();
    ::setenv("ROS_DOMAIN_ID", std::to_string(dds_domain_of_process()).c_str(), 1);
    ::setenv("ROS_LOCALHOST_ONLY", "1", 1);
    write("rover/robot.yaml",
          "robot: rover\nlibraries: [segue_components_ros2]\ncontrollers: [controllers/*.yaml]\n");
    write("rover/controllers/idle.yaml", "tasks: {}\n");
    write("rover/controllers/talk.yaml", network("100s"));
    write("rover/controllers/hasty.yaml", network("8s"));
    start({"--controller", "idle"});
    ASSERT_NO_FATAL_FAILURE(wait_for_controller("idle"));
  }

  /// Two nodes, of which one has the fault.
  static std::string network(const std::string& timeout) {
    const auto task = [&](const std::string& name) {
      return "  " + name + ": {component: 'ros2::ManagedNode', properties: {name: /" + name +
             ", timeout: " + timeout + "}}\n";
    };
    return "tasks:\n" + task("sound") + task("talker") + "deployments: {ros2: {tasks: [sound, talker]}}\n";
  }
  static std::unique_ptr<Peer> make_peer() {
    const auto domain = dds_domain_of_process();
    return GetParam() == Middleware::FastDds ? ::ros2::testing::make_fast_peer(domain)
                                             : ::ros2::testing::make_cyclone_peer(domain);
  }
  Finished switch_to(const std::string& name) { return segue({"switch", name, "--timeout", "200s"}); }

  /// The switch fails, with these words to whoever asked for it and in the robot's events, and both nodes
  /// are as before.
  void expect_undone(const std::string& name, const ::testing::Matcher<std::string>& words) {
    const auto finished = switch_to(name);
    EXPECT_NE(finished.status, 0);
    EXPECT_THAT(finished.output + finished.errors, words);
    EXPECT_THAT(segue({"events"}).output, ::testing::AllOf(HasSubstr("transition_undone"), words));
    EXPECT_EQ(controller(), "idle");
    EXPECT_EQ(sound.state(), 1) << "what was done with the other one is taken back";
  }
  /// The switch is done, and the way back is, too.
  void expect_done() {
    const auto finished = switch_to("talk");
    EXPECT_EQ(finished.status, 0) << finished.output << finished.errors;
    EXPECT_EQ(talker.state(), 3);
    EXPECT_EQ(controller(), "talk");
    EXPECT_EQ(switch_to("idle").status, 0);
    EXPECT_EQ(talker.state(), 1);
    EXPECT_EQ(talker.transitions(), (std::vector<int>{1, 3, 4, 2})) << "asked once for each";
  }
  bool eventually_logs(const std::string& text) {
    return eventually([&] { return segue({"events"}).output.find(text) != std::string::npos; });
  }

  ManagedPeer sound{make_peer, "/sound"};
  ManagedPeer talker{make_peer, "/talker"};
};

TEST_P(FaultyNodes, ThatNeverAnswerUndoTheSwitch) {
  talker.set_fault(Fault::AnswersNever);
  expect_undone("hasty", HasSubstr("/talker"));
  EXPECT_EQ(talker.state(), 1);
}

TEST_P(FaultyNodes, ThatAnswerLateAreSwitched) {
  talker.set_fault(Fault::AnswersLate);
  expect_done();
}

TEST_P(FaultyNodes, WhoseAnswerIsLostAreSwitched) {
  write("rover/controllers/talk.yaml", network("20s"));
  EXPECT_EQ(segue({"apply"}).status, 0);
  talker.set_fault(Fault::AnswersNothing);
  expect_done();
}

TEST_P(FaultyNodes, ThatRefuseATransitionUndoTheSwitch) {
  talker.set_fault(Fault::Refuses);
  expect_undone("talk", HasSubstr("node /talker refuses to configure; it is unconfigured"));
}

TEST_P(FaultyNodes, ThatFailToActivateUndoTheSwitch) {
  talker.set_fault(Fault::FailsToActivate);
  expect_undone("talk", HasSubstr("node /talker failed to activate; it is unconfigured"));
}

TEST_P(FaultyNodes, ThatDieInConfigureUndoTheSwitch) {
  talker.set_fault(Fault::DiesInConfigure);
  expect_undone("hasty", HasSubstr("/talker"));
}

TEST_P(FaultyNodes, ThatAreThereTwiceUndoTheSwitch) {
  const ManagedPeer twin{make_peer, "/talker"};
  talker.set_fault(Fault::SaysDoneOnly);
  // The second one may be found after the first one has said that it is done.
  std::string said;
  EXPECT_TRUE(eventually([&] {
    const auto finished = switch_to("talk");
    said = finished.output + finished.errors;
    return said.find("node /talker is there twice, and both answer: end one") != std::string::npos;
  })) << said;
  expect_undone("talk", HasSubstr("/talker"));
}

TEST_P(FaultyNodes, ThatBecomeTwoWhileTheyRunAreSaid) {
  ASSERT_EQ(switch_to("talk").status, 0);
  const ManagedPeer twin{make_peer, "/talker"};
  EXPECT_TRUE(eventually_logs("node /talker is there twice, and both answer: end one"));
  EXPECT_EQ(sound.state(), 3) << "the other one goes on";
}

TEST_P(FaultyNodes, ThatLieAboutTheirStateUndoTheSwitch) {
  talker.set_fault(Fault::SaysDoneOnly);
  expect_undone("talk", HasSubstr("node /talker says that it did configure; it is unconfigured"));
}

TEST_P(FaultyNodes, WhoseAnswersAreMalformedAreSwitched) {
  talker.set_fault(Fault::Malformed);
  expect_done();
}

TEST_P(FaultyNodes, WhoseStateIsMalformedUndoTheSwitch) {
  talker.set_fault(Fault::HasNoState);
  expect_undone("talk", HasSubstr("/talker/get_state"));
}

TEST_P(FaultyNodes, ThatComeAndGoAHundredTimesGoOn) {
  ASSERT_EQ(switch_to("talk").status, 0);
  for (int i = 0; i < 100; ++i) {
    talker.hide(true);
    ASSERT_TRUE(eventually([&] { return !talker.is_served(); })) << i;
    talker.hide(false);
    ASSERT_TRUE(eventually([&] { return talker.is_served(); })) << i;
  }
  talker.hide(true);
  EXPECT_TRUE(eventually_logs("the services of its life cycle are not seen"));
  talker.hide(false);
  EXPECT_TRUE(eventually([&] { return segue({"status"}).output.find("unseen") == std::string::npos; }));
  EXPECT_EQ(controller(), "talk");
  EXPECT_EQ(switch_to("idle").status, 0);
  EXPECT_EQ(talker.transitions(), (std::vector<int>{1, 3, 4, 2}));
}

INSTANTIATE_TEST_SUITE_P(, FaultyNodes, ::testing::Values(Middleware::FastDds, Middleware::Cyclone),
                         [](const auto& given) {
                           return given.param == Middleware::FastDds ? "WithFastDds" : "WithCyclone";
                         });

}  // namespace
}  // namespace segue::testing

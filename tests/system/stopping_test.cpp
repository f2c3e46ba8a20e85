// SPDX-License-Identifier: Apache-2.0
//
// What brings a robot to rest, through the command line: people, missions that end in every way, and whoever
// does something beside them.
#include <gmock/gmock.h>

#include <csignal>
#include <memory>
#include <string>
#include <vector>

#include "system_test.hpp"

namespace segue::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr const char* kDrive = R"(mission: drive
actions:
  drive: {run: {controller: explore, until: [{task: wanderer, state: stopped}, {after: 10min}]}}
start: drive
states:
  drive: {on: {success: return success}}
)";

class Stopping : public SystemTest {
 protected:
  void SetUp() override {
    SystemTest::SetUp();
    start({"--controller", "explore"});
  }
  bool is_at_rest() {
    const auto status = json({"status"});
    const auto* halt = status.find("halt");
    const auto* state = halt == nullptr ? nullptr : halt->find("state");
    return state != nullptr && *state == type::Value("at_rest") &&
           status.find("controller")->as_string() == "hold";
  }
  std::unique_ptr<Process> begin_mission(const std::string& text) {
    write("drive.yaml", text);
    auto mission = std::make_unique<Process>(command({"mission", "run", "drive.yaml"}), folder_);
    EXPECT_TRUE(eventually([&] {
      return segue({"mission", "status"}).output.find("under way: drive") != std::string::npos;
    })) << segue({"mission", "status"}).errors;
    return mission;
  }
};

TEST_F(Stopping, ByAPersonHoldsUntilItIsReleased) {
  const auto stopped = segue({"stop"});
  EXPECT_EQ(stopped.status, 0) << stopped.errors;
  EXPECT_THAT(stopped.output, StartsWith("stopped; the robot is at rest after "));
  EXPECT_THAT(segue({"status"}).output, HasSubstr("until `segue stop --release`"));
  const auto refused = segue({"switch", "explore"});
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.errors, HasSubstr("'segue stop --release' lets it be commanded again"));
  write("drive.yaml", kDrive);
  EXPECT_EQ(segue({"mission", "run", "drive.yaml"}).status, 1);
  EXPECT_EQ(controller(), "hold");
  EXPECT_EQ(segue({"stop", "--release"}).status, 0);
  EXPECT_EQ(segue({"stop", "--release"}).status, 1);
  EXPECT_EQ(segue({"switch", "explore"}).status, 0);
}

TEST_F(Stopping, EndsTheMissionThatCommandsTheRobot) {
  auto mission = begin_mission(kDrive);
  const auto rest = json({"stop"});
  EXPECT_EQ(*rest.find("at_rest"), type::Value(true));
  const auto ended = mission->wait();
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.errors, HasSubstr("who halted it"));
  EXPECT_EQ(controller(), "hold");
}

TEST_F(Stopping, FollowsAMissionThatIsInterruptedOrKilled) {
  for (const int signal : {SIGINT, SIGTERM, SIGKILL}) {
    SCOPED_TRACE(signal);
    auto mission = begin_mission(kDrive);
    mission->signal(signal);
    const auto ended = mission->wait();
    if (signal == SIGKILL) {
      EXPECT_TRUE(eventually([&] { return is_at_rest(); })) << segue({"status"}).output;
    } else {
      EXPECT_THAT(ended.errors, HasSubstr("the robot is at rest after ")) << "it waits for that";
      EXPECT_TRUE(is_at_rest());
    }
  }
}

TEST_F(Stopping, DoesNotFollowAMissionThatLetsTheRobotRunOn) {
  for (const int signal : {SIGINT, SIGKILL}) {
    SCOPED_TRACE(signal);
    auto mission = begin_mission("at_end: keep\n" + std::string(kDrive));
    mission->signal(signal);
    (void)mission->wait();
    ASSERT_TRUE(eventually([&] {
      return segue({"mission", "status"}).status != 0;
    })) << "it has been given back";
    EXPECT_EQ(controller(), "explore");
  }
}

TEST_F(Stopping, WhatOthersDoBesideAMissionIsRefusedUnlessItIsMeant) {
  auto mission = begin_mission(kDrive);
  for (const std::vector<std::string>& verb : {std::vector<std::string>{"set", "wanderer.speed=0.1"},
                                               {"call", "odometry.reset"},
                                               {"write", "drive.command={forward: 0.0, turn: 0.0}"}}) {
    SCOPED_TRACE(verb.front());
    const auto refused = segue(verb);
    EXPECT_EQ(refused.status, 1);
    EXPECT_THAT(refused.errors, HasSubstr("the robot is commanded by "));
    EXPECT_THAT(refused.errors, HasSubstr("--beside-mission"));
    auto meant = verb;
    meant.emplace_back("--beside-mission");
    const auto done = segue(meant);
    EXPECT_EQ(done.status, 0) << done.errors;
  }
  EXPECT_THAT(segue({"events"}).output, HasSubstr("sets wanderer.speed, beside what "));
  mission->signal(SIGINT);
  (void)mission->wait();
  EXPECT_EQ(segue({"call", "odometry.reset"}).status, 0) << "nobody commands the robot any more";
}

TEST_F(Stopping, OfARobotThatDoesNotSayWhatRestIsStopsItsDevices) {
  (void)stop();
  write("rover/robot.yaml",
        "robot: rover\nlibraries: [segue_components_demo]\ncontrollers: [controllers/*.yaml]\n");
  start({"--controller", "explore"});
  wait_for_controller("explore");
  const auto stopped = segue({"stop"});
  EXPECT_EQ(stopped.status, 0) << stopped.errors;
  EXPECT_THAT(stopped.output, HasSubstr("stopped, since they hold devices: drive"));
  EXPECT_EQ(json({"task", "drive"}).find("state")->as_string(), "stopped");
}

}  // namespace
}  // namespace segue::testing

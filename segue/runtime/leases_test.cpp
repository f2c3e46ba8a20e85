// SPDX-License-Identifier: Apache-2.0
//
// Who may command a robot: the holder of its lease, who takes it over, and what others may do beside.
#include <segue/runtime/controller_set.hpp>
#include <segue/runtime/halting_robot.hpp>
#include <segue/runtime/served_runtime.hpp>

#include <support/eventually.hpp>

#include <gmock/gmock.h>

#include <string>
#include <vector>

namespace segue::runtime {
namespace {

using model::NetworkName;
using ::testing::Contains;
using testing::network_of;
using Robot = testing::HaltingRobot;

TEST(Lease, KeepsOthersFromSettingCallingAndWritingUnlessTheyMeanIt) {
  Robot robot;
  EXPECT_TRUE(robot.runtime.served().allow({"ann"}, "sets x")) << "nobody commands the robot";
  const auto lease = robot.runtime.served().take_lease("mission a").value();
  EXPECT_TRUE(robot.runtime.served().allow({"mission a", lease}, "sets x"));
  EXPECT_EQ(robot.runtime.served().allow({"ann"}, "sets x").error().code, ErrorCode::InvalidState);
  EXPECT_TRUE(robot.runtime.served().allow({"ann", 0, true}, "sets x"));
  std::vector<std::string> events;
  for (const auto& event : robot.runtime.events())
    events.push_back(event.message);
  EXPECT_THAT(events, Contains("ann sets x, beside what mission a does"));
}

TEST(Lease, ThatIsLostPermitsNothingAlthoughAnotherIsHeld) {
  Robot robot;
  const auto lost = robot.runtime.served().take_lease("mission a").value();
  robot.runtime.served().end_lease(lost, true);
  ASSERT_TRUE(robot.runtime.served().take_lease("mission b"));
  EXPECT_EQ(robot.runtime.served().allow({"mission a", lost, true}, "sets x").error().code,
            ErrorCode::InvalidState);
}

TEST(Lease, ThatEndsTakesWithItWhatWasPreparedMeanwhile) {
  for (const bool is_taken_over : {false, true}) {
    Robot robot{RuntimeOptions{}};
    const auto plain = robot.host.observe();
    const auto lease = robot.runtime.served().take_lease("ann").value();
    robot.runtime.served().prepare({NetworkName("work")}, lease).get();
    EXPECT_FALSE(equivalent(robot.host.observe(), plain));
    if (is_taken_over) {
      EXPECT_EQ(robot.switch_to("drive", {.who = "eve", .take_over = true}).outcome, Outcome::Done);
    } else {
      robot.runtime.served().end_lease(lease);
    }
    EXPECT_TRUE(robot.runtime.served().prepare({NetworkName("work")}, lease).get().empty()) << "too late";
    EXPECT_TRUE(segue::testing::eventually([&] { return equivalent(robot.host.observe(), plain); }));
  }
}

TEST(Lease, ThatWasLostAllowsNothingAnyMore) {
  Robot robot;
  const auto lease = robot.runtime.served().take_lease("mission a").value();
  (void)robot.runtime.halt({.who = "ann"}).get();
  EXPECT_EQ(robot.runtime.served().allow({"mission a", lease, true}, "sets x").error().code,
            ErrorCode::InvalidState);
}

TEST(TakeOver, ByARequestThatCannotBeCarriedOutTakesTheRobotFromNobody) {
  Robot robot;
  const auto lease = robot.runtime.served().take_lease("mission a").value();
  RequestOptions options;
  options.take_over = true;
  options.who = "ann";
  EXPECT_EQ(robot.switch_to("no_such_controller", options).outcome, Outcome::Refused);
  RequestOptions wrong = options;
  wrong.properties.push_back({model::TaskId("no_such_task"), "speed", 1});
  EXPECT_EQ(robot.switch_to("work", wrong).outcome, Outcome::Refused);
  ControllerSet broken;
  broken.controllers.push_back(
      network_of("network: x\ntasks: {a: {component: \"x::A\"}}\nconnections: [a.out -> b.in]\n"));
  EXPECT_EQ(robot.runtime.apply(broken, options).get().outcome, Outcome::Refused);
  EXPECT_FALSE(robot.runtime.served().lease_standing(lease).lost_to);
  EXPECT_EQ(robot.switch_to("work", options).outcome, Outcome::Done);
  EXPECT_THAT(robot.runtime.served().lease_standing(lease).lost_to, ::testing::Optional(std::string("ann")));
}

}  // namespace
}  // namespace segue::runtime

// SPDX-License-Identifier: Apache-2.0
#include <segue/model/network_sets.hpp>
#include <segue/model/validate.hpp>
#include <segue/solve/combine.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <support/network_of.hpp>
#include <support/random_networks.hpp>

#include <string>

namespace segue::solve {
namespace {

using model::Network;
using segue::testing::network_of;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

const char* const kDrive = R"(
network: drive
tasks:
  base: {component: demo::Drive, properties: {gain: 1}}
  follower: {component: demo::Follower}
connections: [follower.command -> base.command]
)";

std::vector<Conflict> with_drive(const std::string& text) {
  return conflicts(network_of(kDrive), network_of(text), {});
}

TEST(Combine, NetworksThatShareNothingOrTheSameTasksRunAtOnce) {
  EXPECT_THAT(with_drive("network: arm\ntasks: {arm: {component: demo::Arm}}"), IsEmpty());
  EXPECT_THAT(with_drive("network: arm\ntasks: {base: {component: demo::Drive, properties: {gain: 1}}}"),
              IsEmpty());
}

TEST(Combine, TheUnionHasTheNamesAndPartsOfAll) {
  const auto both = combine({network_of(kDrive), network_of(R"(
network: arm
tasks: {arm: {component: demo::Arm}, base: {component: demo::Drive, properties: {gain: 1}}}
connections: [base.state -> arm.base]
)")},
                            {});
  ASSERT_TRUE(both) << to_string(both.error());
  EXPECT_EQ(both->name.str(), "drive+arm");
  EXPECT_THAT(both->tasks, SizeIs(3));
  EXPECT_THAT(both->connections, SizeIs(2));
}

TEST(Combine, ATaskMustBeTheSameInBoth) {
  const auto of = [](const std::string& task) {
    const auto found = with_drive("network: arm\ntasks: {base: " + task + "}");
    EXPECT_THAT(found, SizeIs(1));
    return found.empty() ? Conflict{} : found.front();
  };
  EXPECT_EQ(of("{component: demo::Drive, properties: {gain: 2}}"),
            (Conflict{"task base", "task 'base' is configured differently in 'drive' and 'arm'"}));
  EXPECT_THAT(of("{component: demo::Other, properties: {gain: 1}}").reason,
              HasSubstr("is of another component"));
  EXPECT_THAT(of("{component: demo::Drive, properties: {gain: 1}, state: stopped}").reason,
              HasSubstr("is in another state"));
}

TEST(Combine, ATaskMustBeInTheSameProcess) {
  const auto found = with_drive(R"(
network: arm
tasks: {base: {component: demo::Drive, properties: {gain: 1}}}
deployments: {arm: {tasks: [base]}}
)");
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_THAT(found.front().reason, HasSubstr("runs in another process"));
}

TEST(Combine, ADeviceIsHeldOnce) {
  const auto drive = network_of("network: a\ntasks: {x: {component: demo::X, exclusive: [can0]}}");
  const auto other = network_of("network: b\ntasks: {y: {component: demo::Y, exclusive: [can0]}}");
  const auto found = conflicts(drive, other, {});
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_THAT(found.front().reason, HasSubstr("is held by task 'x' of 'a' and by task 'y' of 'b'"));
  const auto idle =
      network_of("network: b\ntasks: {y: {component: demo::Y, exclusive: [can0], state: pre_operational}}");
  EXPECT_THAT(conflicts(drive, idle, {}), IsEmpty()) << "only configured tasks hold devices";
}

TEST(Combine, WritersOfOneInputOverwriteEachOtherUnlessSamplesQueue) {
  const auto other = [](const std::string& policy) {
    return R"(
network: stick
tasks: {base: {component: demo::Drive, properties: {gain: 1}}, stick: {component: demo::Stick}}
connections: [{from: stick.command, to: base.command)" +
           policy + "}]";
  };
  const auto found = with_drive(other(""));
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found.front().what, "input base.command");
  const auto queued = network_of(other(", policy: buffer, size: 4"));
  Network drive = network_of(kDrive);
  drive.connections.front().policy = {BufferKind::Buffer, 4, Transport::Automatic, false};
  EXPECT_THAT(conflicts(drive, queued, {}), IsEmpty());
}

TEST(Combine, TwoPortsAreConnectedOnce) {
  const auto with = [](const std::string& name, const std::string& policy) {
    return network_of("network: " + name + "\ntasks: {a: {component: demo::A}, b: {component: demo::B}}\n" +
                      "connections: [{from: a.out, to: b.in, " + policy + "}]");
  };
  const auto found =
      conflicts(with("x", "policy: buffer, size: 4"), with("y", "policy: buffer, size: 5"), {});
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found.front().reason, "connection a.out -> b.in has different policies in 'x' and 'y'");
}

TEST(Combine, ANetworkMayInfluenceAnotherThatItDoesNotConflictWith) {
  const auto alone =
      network_of("network: alone\ntasks: {base: {component: demo::Drive, properties: {gain: 1}}}");
  const auto drive = network_of(kDrive);
  EXPECT_THAT(conflicts(drive, alone, {}), IsEmpty());
  EXPECT_EQ(
      influences(drive, alone),
      (std::vector<Conflict>{
          {"input base.command", "follower.command of 'drive' writes to input 'base.command' of 'alone'"}}));
  EXPECT_THAT(influences(alone, drive), IsEmpty());
  EXPECT_THAT(influences(drive, drive), IsEmpty());
}

TEST(Combine, ProcessesAreStartedInOneWay) {
  const auto a = network_of(
      "network: a\ntasks: {x: {component: demo::X}}\ndeployments: {p: {tasks: [x], priority: 5, scheduler: "
      "fifo}}");
  const auto b = network_of("network: b\ntasks: {y: {component: demo::Y}}\ndeployments: {p: {tasks: [y]}}");
  const auto found = conflicts(a, b, {});
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found.front().what, "process localhost/p");
}

TEST(Combine, WhatCannotRunAtOnceIsRefusedWithAllReasons) {
  const auto both = combine({network_of(kDrive), network_of(R"(
network: arm
tasks: {base: {component: demo::Drive}, follower: {component: demo::Other}}
)")},
                            {});
  ASSERT_FALSE(both);
  EXPECT_EQ(
      to_string(both.error()),
      "these controllers cannot run at once: task 'base' is configured differently in 'drive' and 'arm'; "
      "task 'follower' is of another component in 'drive' and 'arm'");
}

/// Networks that conflict nowhere: their union is valid, and each is a part of it.
RC_GTEST_PROP(Combine, UnionsAreValidAndHoldBoth, (std::uint64_t seed)) {
  testing::Random random(seed);
  testing::NetworkShape shape;
  shape.tasks = 3;
  shape.processes = 2;
  shape.connections = 2;
  Network a = testing::random_network(random, shape);
  Network b = testing::random_network(random, shape);
  for (const Network* one : {&a, &b})
    RC_PRE(!model::validate(*one, {}, model::Depth::Structure).has_errors());
  RC_ASSERT(conflicts(a, a, {}).empty());
  const bool are_compatible = conflicts(a, b, {}).empty();
  RC_ASSERT(are_compatible == conflicts(b, a, {}).empty());
  const auto both = combine({a, b}, {});
  RC_ASSERT(both.has_value() == are_compatible);
  RC_CLASSIFY(are_compatible);
  if (!both) return;
  RC_ASSERT(model::includes(*both, a));
  RC_ASSERT(model::includes(*both, b));
  const Diagnostics problems = model::validate(*both, {}, model::Depth::Structure);
  if (problems.has_errors()) RC_FAIL(to_string(problems));
  const auto reversed = combine({b, a}, {});
  RC_ASSERT(reversed.has_value());
  RC_ASSERT(model::equivalent(*both, *reversed));
}

}  // namespace
}  // namespace segue::solve

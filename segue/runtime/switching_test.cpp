// SPDX-License-Identifier: Apache-2.0
//
// Many switches in one process: the Artemis controllers, and random networks; and what is kept of their
// results.
#include <segue/runtime/embedded_robot.hpp>
#include <segue/runtime/test_support.hpp>

#include <support/eventually.hpp>
#include <support/paths.hpp>
#include <support/random_networks.hpp>

#include <gmock/gmock.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>

namespace segue::runtime {
namespace {

using segue::testing::eventually;
using testing::entries;
using testing::runnable;

const std::string kArtemis = segue::paths::in_sources("/examples/04_artemis/robot.yaml");

TEST(Artemis, AllTwelveTransitionsReachTheirTargets) {
  auto robot = EmbeddedRobot::open(kArtemis, {.stand_in = true});
  ASSERT_TRUE(robot) << to_string(diagnostics_of(robot.error()));
  Runtime& runtime = robot->runtime();
  const auto names = runtime.controllers();
  ASSERT_EQ(names.size(), 4U);
  for (const auto& from : names) {
    for (const auto& to : names) {
      ASSERT_EQ(runtime.switch_to(from).outcome, Outcome::Done);
      const auto result = runtime.switch_to(to);
      ASSERT_EQ(result.outcome, Outcome::Done) << from.str() << " to " << to.str() << ": " << result.why();
      EXPECT_THAT(differences(*runtime.controller(to), runtime.belief()), ::testing::IsEmpty());
      EXPECT_THAT(runtime.observed_differences(), ::testing::IsEmpty());
    }
  }
  EXPECT_EQ(robot->shut_down().outcome, Outcome::Done);
  EXPECT_TRUE(robot->host().observe().empty());
}

/// The number of threads of this process, without those that the host keeps for its next batch.
std::size_t threads_now() {
  std::size_t count = 0;
  for (const auto& thread : std::filesystem::directory_iterator("/proc/self/task")) {
    std::string name;
    std::getline(std::ifstream(thread.path() / "comm"), name);
    count += name == "segue-actions" || name == "segue-deadlines" ? 0 : 1;
  }
  return count;
}

/// Threads that have ended leave /proc a moment after they are joined.
std::size_t settled_threads(std::size_t most) {
  (void)eventually([&] { return threads_now() <= most; }, std::chrono::seconds(10));
  return threads_now();
}

/// Reading /proc opens a descriptor itself, in each count alike.
std::size_t settled_descriptors(std::size_t most) {
  (void)eventually([&] { return entries("/proc/self/fd") <= most; }, std::chrono::seconds(10));
  return entries("/proc/self/fd");
}

TEST(RandomNetworks, HundredsOfSwitchesReachTheirTargetsAndLeakNothing) {
  segue::testing::NetworkShape shape;
  shape.attributes = false;
  testing::StandInRobot robot;
  ASSERT_EQ(robot.runtime.switch_to(model::Network{}).outcome, Outcome::Done);
  const std::size_t threads = threads_now();
  const std::size_t descriptors = entries("/proc/self/fd");
  segue::testing::Random random(20261121);
  model::Network network;
  for (int round = 0; round < 400; ++round) {
    network = runnable(round % 2 == 0 ? segue::testing::random_network(random, shape)
                                      : segue::testing::random_variation(random, network, shape));
    network.name = model::NetworkName("round" + std::to_string(round));
    const auto result = robot.runtime.switch_to(network);
    ASSERT_EQ(result.outcome, Outcome::Done) << round << ": " << result.why();
    ASSERT_THAT(differences(network, robot.runtime.belief()), ::testing::IsEmpty()) << round;
    ASSERT_THAT(robot.runtime.observed_differences(), ::testing::IsEmpty()) << round;
  }
  ASSERT_EQ(robot.runtime.switch_to(model::Network{}).outcome, Outcome::Done);
  EXPECT_LE(settled_threads(threads), threads);
  EXPECT_LE(settled_descriptors(descriptors), descriptors);
}

TEST(KeptResults, TakeABoundedMemory) {
  RuntimeOptions options;
  options.kept_bytes = std::size_t{64} << 10;
  testing::StandInRobot robot(options);
  std::string many = "network: many\ntasks:\n";
  for (int i = 0; i < 10; ++i)
    many += "  t" + std::to_string(i) + ": {component: x::A}\n";
  const auto full = testing::network_of(many);
  for (int i = 0; i < 10; ++i) {
    ASSERT_EQ(robot.runtime.switch_to(full).outcome, Outcome::Done);
    ASSERT_EQ(robot.runtime.switch_to(model::NetworkName()).outcome, Outcome::Done);
  }
  std::size_t actions = 0;
  for (const auto& result : robot.runtime.history())
    actions += result.actions.size();
  EXPECT_GT(actions, 0U);
  EXPECT_LT(actions * sizeof(ActionRecord), options.kept_bytes);
}

TEST(KeptResults, AreTheNewestOneAtLeast) {
  RuntimeOptions options;
  options.kept_bytes = 1;
  testing::StandInRobot robot(options);
  ASSERT_EQ(
      robot.runtime.switch_to(testing::network_of("network: one\ntasks: {a: {component: x::A}}\n")).outcome,
      Outcome::Done);
  ASSERT_EQ(robot.runtime.switch_to(model::NetworkName()).outcome, Outcome::Done);
  EXPECT_THAT(robot.runtime.history(), ::testing::SizeIs(1));
}

TEST(EmbeddedRobotFile, ReportsAllProblemsOfAllFiles) {
  EXPECT_FALSE(EmbeddedRobot::open("no_such_robot.yaml"));
  const auto refused = EmbeddedRobot::open(kArtemis);
  ASSERT_FALSE(refused) << "its components are not installed";
  EXPECT_FALSE(refused.error().where.file.empty());
  EXPECT_GT(diagnostics_of(refused.error()).error_count(), 1U);
}

}  // namespace
}  // namespace segue::runtime

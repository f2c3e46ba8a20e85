// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/left_actions.hpp>
#include <segue/runtime/test_support.hpp>

#include <gtest/gtest.h>

namespace segue::runtime::detail {
namespace {

using model::Action;
using model::ActionKind;
using testing::network_of;

const char* const kDrive =
    "network: drive\n"
    "tasks: {wheels: {component: \"x::Wheels\"}, camera: {component: \"x::Camera\"}}\n"
    "connections: [camera.image -> wheels.command]\n"
    "deployments: {vision: {tasks: [camera]}, base: {tasks: [wheels]}}\n";

Action on_task(ActionKind kind, const char* task) {
  return {1, kind, model::TaskAction{model::TaskId(task)}, model::Phase::Prepare, {}};
}

Action on_process(ActionKind kind, const model::Network& network, std::size_t which) {
  return {1, kind, model::DeploymentAction{network.deployments.at(which), false}, model::Phase::Prepare, {}};
}

TEST(NetworkParts, AreIndependentOfWhatConcernsOtherTasksAndProcesses) {
  const auto drive = network_of(kDrive);
  NetworkParts parts;
  parts.add(drive);
  EXPECT_FALSE(parts.are_independent_of(on_task(ActionKind::Configure, "camera")));
  EXPECT_FALSE(parts.are_independent_of(on_task(ActionKind::Configure, "camera@localhost/new")));
  EXPECT_TRUE(parts.are_independent_of(on_task(ActionKind::Configure, "arm")));
  EXPECT_FALSE(parts.are_independent_of(on_process(ActionKind::Undeploy, drive, 0)));
  auto connection = drive.connections.front();
  const auto connect = [&] {
    return Action{1, ActionKind::Connect, model::ConnectionAction{connection}, model::Phase::Prepare, {}};
  };
  EXPECT_FALSE(parts.are_independent_of(connect()));
  connection.from.task = model::TaskId("arm");
  EXPECT_TRUE(parts.are_independent_of(connect())) << "it carries nothing before the arm runs";
  EXPECT_TRUE(NetworkParts().are_independent_of(on_process(ActionKind::Undeploy, drive, 0)));
}

TEST(LeftActions, AreKnownUntilTheyHaveEnded) {
  int changes = 0;
  LeftActions left([&] { ++changes; });
  NetworkParts parts;
  parts.add(network_of(kDrive));
  left.add(on_task(ActionKind::Configure, "arm"));
  EXPECT_TRUE(left.any());
  EXPECT_FALSE(left.concern(parts));
  left.add(on_task(ActionKind::Configure, "camera"));
  EXPECT_TRUE(left.concern(parts));
  left.ended(on_task(ActionKind::Configure, "camera"));
  EXPECT_FALSE(left.concern(parts));
  EXPECT_EQ(changes, 1);
  left.close();
  left.ended(on_task(ActionKind::Configure, "arm"));
  EXPECT_FALSE(left.any());
  EXPECT_EQ(changes, 1);
}

TEST(LeftActions, HideProcessesThatBeginOrEnd) {
  LeftActions left([] {});
  const auto drive = network_of(kDrive);
  left.add(on_task(ActionKind::Configure, "camera"));
  EXPECT_EQ(left.without_their_processes(drive), drive);
  left.add(on_process(ActionKind::Undeploy, drive, 0));
  const auto rest = left.without_their_processes(drive);
  ASSERT_EQ(rest.deployments.size(), 1U);
  EXPECT_NE(rest.deployments.front().key(), drive.deployments.front().key());
  EXPECT_EQ(rest.tasks.size(), 1U);
  EXPECT_TRUE(rest.connections.empty());
}

}  // namespace
}  // namespace segue::runtime::detail

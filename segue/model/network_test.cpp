// SPDX-License-Identifier: Apache-2.0
#include <segue/base/diagnostic.hpp>
#include <segue/model/controller_names.hpp>
#include <segue/model/files.hpp>
#include <segue/model/network.hpp>
#include <support/network_of.hpp>
#include <support/random_networks.hpp>

#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

#include <algorithm>

namespace segue::model {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;
using type::Value;

Network two_tasks() {
  Network network;
  network.name = NetworkName("pair");
  network.tasks.resize(2);
  network.tasks[0].id = TaskId("a");
  network.tasks[0].component = ComponentName("demo::Producer");
  network.tasks[1].id = TaskId("b");
  network.tasks[1].component = ComponentName("demo::Consumer");
  network.connections.resize(1);
  network.connections[0].from = {TaskId("a"), "out"};
  network.connections[0].to = {TaskId("b"), "in"};
  return network;
}

TEST(NetworkTest, PlaceInTheFileDoesNotCount) {
  const Network one = two_tasks();
  Network other = one;
  other.tasks[0].where = {"x.yaml", 3, 1};
  other.file = "x.yaml";
  EXPECT_EQ(one, other);
}

TEST(NetworkTest, TakesOverIsNoConfiguration) {
  Task task = two_tasks().tasks[0];
  Task heir = task;
  heir.takes_over = TaskId("old");
  EXPECT_TRUE(task.same_configuration(heir));
  EXPECT_FALSE(task == heir);
  heir.exclusive = {"/dev/video0"};
  EXPECT_FALSE(task.same_configuration(heir));
}

TEST(NetworkTest, ListOfTasksIsNotPartOfTheProcess) {
  Deployment one;
  one.process = ProcessName("drivers");
  Deployment other = one;
  other.tasks.push_back({TaskId("a"), "a"});
  EXPECT_TRUE(one.same_process(other));
  EXPECT_FALSE(one == other);
  other = one;
  other.on_failure = FailurePolicy::Restart;
  EXPECT_TRUE(one.same_process(other));
  EXPECT_FALSE(one == other);
  other.cpus = {1};
  EXPECT_FALSE(one.same_process(other));
}

TEST(NetworkTest, LimitsAndLeniencyArePartOfTheProcess) {
  Deployment one;
  one.process = ProcessName("drivers");
  Deployment other = one;
  other.limits.core = 0;
  EXPECT_FALSE(one.same_process(other));
  other = one;
  other.optional = true;
  EXPECT_FALSE(one.same_process(other));
}

TEST(NetworkTest, ConnectionTextOmitsDefaults) {
  Connection connection = two_tasks().connections[0];
  EXPECT_EQ(to_string(connection), "a.out -> b.in");
  connection.policy = {BufferKind::Buffer, 10, Transport::SharedMemory, false};
  EXPECT_EQ(to_string(connection), "a.out -> b.in (buffer of 10, shm)");
}

TEST(EquivalenceTest, PlacementOfATaskThatTheNetworkLacksDoesNotCount) {
  Network one = two_tasks();
  one.deployments.resize(1);
  one.deployments[0].process = ProcessName("p");
  Network other = one;
  other.deployments[0].tasks.push_back({TaskId("absent"), "absent"});
  EXPECT_TRUE(equivalent(one, other));
  other.deployments[0].tasks.push_back({TaskId("a"), "a"});
  EXPECT_FALSE(equivalent(one, other));
}

TEST(EquivalenceTest, DifferencesAreSentences) {
  const Network one = two_tasks();
  Network other = one;
  other.tasks[0].state = TaskState::Stopped;
  other.connections[0].policy.init = true;
  EXPECT_THAT(differences(one, other), ElementsAre("task 'a': state is stopped, expected running",
                                                   HasSubstr("a.out -> b.in"), HasSubstr("a.out -> b.in")));
  EXPECT_EQ(differences(one, other, 1).size(), 1U);
}

TEST(EquivalenceTest, AMissingConnectionHasItsReason) {
  const Network one = two_tasks();
  Network other = one;
  other.connections.clear();
  const auto why = [](const Connection& connection) { return "nobody reads " + to_string(connection.from); };
  EXPECT_THAT(differences(one, other, 1, why), ElementsAre("connection " + to_string(one.connections.at(0)) +
                                                           " is missing: nobody reads a.out"));
}

TEST(EquivalenceTest, ASecondConnectionCounts) {
  const Network one = two_tasks();
  Network other = one;
  other.connections.push_back(other.connections[0]);
  EXPECT_FALSE(equivalent(one, other));
  EXPECT_FALSE(equivalent(other, one));
}

TEST(EquivalenceTest, ATaskTwiceCounts) {
  const Network one = two_tasks();
  Network other = one;
  other.tasks.push_back(other.tasks[0]);
  EXPECT_FALSE(equivalent(one, other));
}

TEST(EquivalenceTest, WhatDiffersIsNamedWithBothValues) {
  Network one = two_tasks();
  one.deployments = {Deployment{}};
  one.deployments[0].process = ProcessName("p");
  one.tasks[0].properties = type::Value::map({{"gain", 1.5},
                                              {"pose", type::Value::map({{"x", 1}, {"y", 2}})},
                                              {"names", type::Value::List{"a", "b"}}});
  Network other = one;
  other.tasks[0].properties = type::Value::map({{"gain", 2},
                                                {"pose", type::Value::map({{"x", 1}, {"y", 3}})},
                                                {"names", type::Value::List{"a", "c"}},
                                                {"extra", true}});
  other.tasks[1].activity = Activity{};
  other.deployments[0].cpus = {3};
  EXPECT_THAT(differences(one, other),
              ElementsAre("task 'a': property 'gain' is 2, expected 1.5",
                          "task 'a': property 'pose.y' is 3, expected 2",
                          "task 'a': property 'names[1]' is \"c\", expected \"b\"",
                          "task 'a': property 'extra' is true, expected not set",
                          AllOf(HasSubstr("task 'b': activity is "), HasSubstr("expected \"the default\"")),
                          AllOf(HasSubstr("attribute 'cpu' is "), HasSubstr("expected not set"))));
}

TEST(EquivalenceTest, ChangesAreToldAsAnEdit) {
  const Network before = segue::testing::network_of(
      "tasks:\n  a: {component: x::A, properties: {gain: 1}}\n  b: {component: x::B}\n"
      "connections: [a.out -> b.in]\n");
  const Network after = segue::testing::network_of(
      "tasks:\n  a: {component: x::A, properties: {gain: 2}}\n  c: {component: x::C}\n"
      "connections: [a.out -> c.in]\n");
  EXPECT_THAT(
      changes(before, after),
      UnorderedElementsAre("task 'a': property 'gain': 1 -> 2", "task 'b' is removed", "task 'c' is added",
                           "connection a.out -> b.in is removed", "connection a.out -> c.in is added"));
  EXPECT_THAT(changes(after, after), IsEmpty());
}

TEST(NetworkTest, ItsVersionNamesTheTextThatItWasReadFrom) {
  const auto version = [](const char* text) {
    Diagnostics diagnostics;
    const auto network = read_network(text, "test.yaml", diagnostics);
    return network ? network->version : to_string(diagnostics);
  };
  EXPECT_EQ(version("tasks: {a: {component: x::A}}\n"), "ab3a38ca34df");
  EXPECT_NE(version("tasks: {a: {component: x::A}}"), version("tasks: {a: {component: x::A}}\n"));
}

RC_GTEST_PROP(EquivalenceTest, OrderOfListsDoesNotCount, (std::uint64_t seed)) {
  testing::Random random(seed);
  const Network one = testing::random_network(random);
  Network other = one;
  other.name = NetworkName("another");
  std::shuffle(other.tasks.begin(), other.tasks.end(), random);
  std::shuffle(other.deployments.begin(), other.deployments.end(), random);
  std::shuffle(other.connections.begin(), other.connections.end(), random);
  RC_ASSERT(differences(one, other).empty());
  RC_ASSERT(equivalent(other, one));
}

RC_GTEST_PROP(EquivalenceTest, WhatVariesIsSeen, (std::uint64_t seed)) {
  testing::Random random(seed);
  const Network one = testing::random_network(random);
  Network other = testing::random_variation(random, one);
  RC_ASSERT(equivalent(one, other) == equivalent(other, one));
  RC_ASSERT(equivalent(one, other) == differences(one, other).empty());
  if (one.tasks.size() != other.tasks.size()) RC_ASSERT(!equivalent(one, other));
}

TEST(ControllerNamesTest, SeveralAtOnceHaveOneName) {
  const NetworkName arm("arm");
  const NetworkName drive("drive");
  EXPECT_EQ(controllers_in("drive+arm+drive"), (std::vector{arm, drive}));
  EXPECT_EQ(controllers_in("arm"), std::vector{arm});
  EXPECT_TRUE(controllers_in("").empty());
  EXPECT_EQ(joined_name({drive, arm}), NetworkName("arm+drive"));
  EXPECT_EQ(joined_name({}), NetworkName());
}

TEST(TaskIndex, FindsTheFirstTaskOfAnId) {
  Network network;
  for (const char* id : {"a", "b", "a"}) {
    network.tasks.emplace_back().id = TaskId(id);
  }
  const TaskIndex index(network);
  EXPECT_EQ(index.find(TaskId("a")), &network.tasks[0]);
  EXPECT_EQ(index.find(TaskId("b")), &network.tasks[1]);
  EXPECT_EQ(index.find(TaskId("c")), nullptr);
}

}  // namespace
}  // namespace segue::model

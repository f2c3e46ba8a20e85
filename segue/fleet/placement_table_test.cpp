// SPDX-License-Identifier: Apache-2.0
#include <segue/fleet/placement_table.hpp>

#include <segue/task_host/full_id.hpp>

#include <gmock/gmock.h>

namespace segue::fleet::detail {
namespace {

using model::DeploymentKey;
using model::TaskId;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

const TaskId kTask("b");

DeploymentKey process(std::string_view name) {
  return {model::kLocalHost, model::ProcessName(name)};
}

TaskId at(std::string_view name) {
  return task_host::full_id(kTask, process(name));
}

/// The process that an id means; "" where there is none.
std::string where(const PlacementTable& table, const TaskId& id, Which which) {
  const auto place = table.find(id, which);
  return place ? place->process.process.str() : std::string();
}

/// A network that has b in a process.
model::Network in(std::string_view name) {
  model::Network network;
  network.tasks.emplace_back().id = kTask;
  model::Deployment deployment;
  deployment.host = model::kLocalHost;
  deployment.process = model::ProcessName(name);
  deployment.tasks.emplace_back().task = kTask;
  network.deployments.push_back(std::move(deployment));
  return network;
}

/// The current incarnation of b is in p, the next one in q.
void move(PlacementTable& table) {
  table.put({kTask, process("p")});
  table.put({kTask, process("q")});
}

TEST(FullId, ComesApartAsItWasPutTogether) {
  const auto split = task_host::split_id(at("q"));
  EXPECT_EQ(at("q").str(), "b@localhost/q");
  EXPECT_EQ(split.task, kTask);
  EXPECT_EQ(split.process, process("q"));
  EXPECT_EQ(task_host::split_id(kTask).process, std::nullopt);
  EXPECT_EQ(task_host::split_id(TaskId("b@x")).task, TaskId("b@x"))
      << "without a process it is a name like others";
  const auto own = task_host::split_id(task_host::full_id(kTask, DeploymentKey{}));
  ASSERT_TRUE(own.process);
  EXPECT_TRUE(own.process->is_runtime());
}

TEST(PlacementTable, ATaskInOneProcessIsWhatItsPlainIdAndItsFullIdMean) {
  PlacementTable table;
  table.put({kTask, process("p")});
  for (const Which which : {Which::Current, Which::Next}) {
    EXPECT_EQ(where(table, kTask, which), "p");
    EXPECT_EQ(where(table, at("p"), which), "p");
    EXPECT_EQ(where(table, at("q"), which), "");
  }
  EXPECT_EQ(table.name(kTask, process("p")), kTask);
}

TEST(PlacementTable, WhileItMovesTheCurrentOneHasThePlainId) {
  PlacementTable table;
  move(table);
  EXPECT_EQ(where(table, kTask, Which::Current), "p");
  EXPECT_EQ(where(table, kTask, Which::Next), "q");
  EXPECT_EQ(where(table, at("p"), Which::Next), "p") << "a full id means exactly that one";
  EXPECT_EQ(where(table, at("q"), Which::Current), "q");
  EXPECT_EQ(table.name(kTask, process("p")), kTask);
  EXPECT_EQ(table.name(kTask, process("q")), at("q"));
}

TEST(PlacementTable, WhenItHasMovedTheNewOneHasThePlainId) {
  PlacementTable table;
  move(table);
  EXPECT_THAT(table.conclude(), ElementsAre(PlacementTable::Place{kTask, process("p")}));
  EXPECT_EQ(where(table, kTask, Which::Current), "q");
  EXPECT_EQ(table.name(kTask, process("p")), at("p")) << "until it is forgotten";
  table.drop({kTask, process("p")});
  EXPECT_EQ(where(table, at("p"), Which::Current), "");
  EXPECT_THAT(table.conclude(), IsEmpty());
}

TEST(PlacementTable, GivenUpTheNewOneKeepsItsFullId) {
  PlacementTable table;
  move(table);
  table.withdraw();
  EXPECT_EQ(where(table, kTask, Which::Next), "p");
  EXPECT_EQ(table.name(kTask, process("q")), at("q"));
  EXPECT_FALSE(table.free_place(kTask, process("q"))) << "it has to go before it is made anew";
  EXPECT_TRUE(table.free_place(at("q"), process("q"))) << "unless just that one is meant";
  EXPECT_TRUE(table.free_place(kTask, process("r")));
  table.drop({kTask, process("q")});
  EXPECT_TRUE(table.free_place(kTask, process("q")));
}

TEST(PlacementTable, ALeftoverIsTheNextOneOfATransitionThatWantsItWhereItIs) {
  PlacementTable table;
  move(table);
  table.withdraw();
  table.begin_transition(in("p"), in("q"));
  EXPECT_EQ(where(table, kTask, Which::Current), "p");
  EXPECT_EQ(where(table, kTask, Which::Next), "q");
  EXPECT_TRUE(table.free_place(kTask, process("q"))) << "it may be configured again";
  EXPECT_THAT(table.conclude(), ElementsAre(PlacementTable::Place{kTask, process("p")}));
  EXPECT_EQ(where(table, kTask, Which::Current), "q");
}

TEST(PlacementTable, ATransitionKnowsWhereItsTasksWillLive) {
  PlacementTable table;
  EXPECT_EQ(table.wanted(kTask), std::nullopt);
  table.begin_transition(in("p"), in("q"));
  EXPECT_EQ(table.wanted(kTask), process("q"));
  EXPECT_EQ(table.wanted(TaskId("other")), std::nullopt);
  table.withdraw();
  EXPECT_EQ(table.wanted(kTask), std::nullopt);
}

TEST(PlacementTable, ALeftoverElsewhereStaysOne) {
  PlacementTable table;
  move(table);
  table.withdraw();
  table.begin_transition(in("p"), in("p"));
  EXPECT_EQ(where(table, kTask, Which::Next), "p");
  EXPECT_THAT(table.conclude(), IsEmpty());
}

TEST(PlacementTable, WhatWasToBeTakenDownAndHasEndedIsNotWhatComesInItsPlace) {
  PlacementTable table;
  table.put({kTask, process("p")});
  table.drop(process("p"));  // after the transition was planned
  table.begin_transition(in("p"), in("q"));
  table.put({kTask, process("q")});
  EXPECT_EQ(where(table, kTask, Which::Current), "") << "a stop of the old one must not stop the new one";
  EXPECT_EQ(where(table, kTask, Which::Next), "q");
  table.conclude();
  EXPECT_EQ(where(table, kTask, Which::Current), "q");
}

TEST(PlacementTable, ALeftoverIsNotTakenForOneThatEndsInATransition) {
  PlacementTable table;
  move(table);
  table.withdraw();
  table.begin_transition(in("p"), in("r"));
  table.drop(process("p"));
  EXPECT_EQ(where(table, kTask, Which::Current), "");
  table.withdraw();
  EXPECT_EQ(where(table, kTask, Which::Current), "q");
}

TEST(PlacementTable, NothingTakesThePlaceOfOneThatDiesWhileItMoves) {
  PlacementTable table;
  move(table);
  EXPECT_THAT(table.drop(process("p")), ElementsAre(kTask));
  EXPECT_EQ(where(table, kTask, Which::Current), "") << "a stop of the old one must not stop the new one";
  EXPECT_EQ(where(table, kTask, Which::Next), "q");
  EXPECT_EQ(table.name(kTask, process("q")), at("q"));
  table.withdraw();
  EXPECT_EQ(where(table, kTask, Which::Current), "q") << "the only one there is";
}

TEST(PlacementTable, ANewOneThatDiesLeavesTheOldOne) {
  PlacementTable table;
  move(table);
  EXPECT_THAT(table.drop(process("q")), ElementsAre(at("q")));
  EXPECT_EQ(where(table, kTask, Which::Next), "p");
  EXPECT_THAT(table.conclude(), IsEmpty());
}

TEST(PlacementTable, IsUpdatedWithWhatAProcessHoldsAndHoldsNoMore) {
  PlacementTable table;
  table.update(process("p"), {TaskId("a"), kTask}, table.begin_poll());
  table.update(process("q"), {kTask}, table.begin_poll());
  EXPECT_EQ(table.name(kTask, process("q")), at("q"));
  table.update(process("p"), {TaskId("a")}, table.begin_poll());
  EXPECT_EQ(table.name(kTask, process("q")), kTask);
  EXPECT_EQ(where(table, kTask, Which::Current), "q");
  EXPECT_THAT(table.drop(process("p")), ElementsAre(TaskId("a")));
  EXPECT_THAT(table.drop(process("q")), ElementsAre(kTask));
  EXPECT_EQ(where(table, kTask, Which::Next), "");
}

TEST(PlacementTable, APollIsOlderThanWhatWasDoneSinceItBegan) {
  PlacementTable table;
  table.put({TaskId("a"), process("p")});
  auto poll = table.begin_poll();
  table.put({kTask, process("p")});
  table.drop({TaskId("a"), process("p")});
  table.update(process("p"), {TaskId("a")}, poll);
  EXPECT_EQ(where(table, kTask, Which::Current), "p");
  EXPECT_EQ(where(table, TaskId("a"), Which::Current), "");
  table.update(process("p"), {TaskId("a")}, table.begin_poll());
  EXPECT_EQ(where(table, kTask, Which::Current), "") << "a newer poll sees what has become of it";
  EXPECT_EQ(where(table, TaskId("a"), Which::Current), "p");
  poll = table.begin_poll();
  table.drop(process("p"));
  table.update(process("p"), {TaskId("a")}, poll);
  EXPECT_EQ(where(table, TaskId("a"), Which::Current), "") << "that process is gone";
}

TEST(PlacementTable, OneThatAPollSawBeforeItWasPutIsNextAllTheSame) {
  PlacementTable table;
  table.put({kTask, process("p")});
  table.update(process("q"), {kTask}, table.begin_poll());
  table.put({kTask, process("q")});
  EXPECT_EQ(where(table, kTask, Which::Next), "q");
}

TEST(PlacementTable, TheRuntimesOwnProcessIsOneWhateverItsHostIsCalled) {
  PlacementTable table;
  table.put({kTask, process("p")});
  const DeploymentKey own{model::kLocalHost, {}};
  const auto place = table.free_place(kTask, own);
  ASSERT_TRUE(place);
  table.put(*place);
  ASSERT_TRUE(table.find(kTask, Which::Next));
  EXPECT_TRUE(table.find(kTask, Which::Next)->process.is_runtime());
  EXPECT_TRUE(table.find(task_host::full_id(kTask, own), Which::Current));
}

}  // namespace
}  // namespace segue::fleet::detail

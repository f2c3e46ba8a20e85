// SPDX-License-Identifier: Apache-2.0
// Nodes that run before it is certain that they count, and the resources that they may hold meanwhile.
#include <segue/task_network/concurrent_engine.hpp>
#include <segue/task_network/simulated_environment.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <memory>

namespace segue::task_network {
namespace {

using namespace std::chrono_literals;

RunResult simulate(const TaskNetwork& network, const ConcurrentEngineOptions& options = {}) {
  const Order order = derive_order(network);
  SimulatedEnvironment environment(network);
  return ConcurrentEngine(network, order, environment, options).run();
}

/// Appends a node that drives for so long; "there()" holds afterwards.
FactId append_drive(TaskNetwork& network, Duration duration) {
  const FactId there = *network.facts.intern("there()");
  NodeSpec drive;
  drive.duration = duration;
  drive.effects = {{there, true}};
  network.append(drive);
  return there;
}

/// How many of `planners` run ahead while the robot still drives, with so many copies of the world.
std::uint32_t running_ahead(std::uint32_t planners, std::uint32_t copies) {
  TaskNetwork network;
  NodeSpec plan;
  plan.kind = ActionClass::Pure;
  plan.preconditions = {{append_drive(network, 10s), true}};
  plan.duration = 1s;
  for (std::uint32_t i = 0; i < planners; ++i)
    network.append(plan);
  ConcurrentEngineOptions options;
  options.world_copies = copies;
  const RunResult result = simulate(network, options);
  EXPECT_TRUE(result.done());
  return static_cast<std::uint32_t>(std::ranges::count_if(
      result.nodes, [](const NodeResult& node) { return node.ended < TimePoint(10s); }));
}

TEST(Speculation, AsManyRunAheadAsThereAreCopiesOfTheWorld) {
  EXPECT_EQ(running_ahead(5, 1), 1U);
  EXPECT_EQ(running_ahead(5, 4), 4U);
}

TEST(Speculation, WithoutItWhoLooksAtTheWorldBeginsWhenAllBeforeHavePassed) {
  TaskNetwork network;
  append_drive(network, 5s);
  NodeSpec survey;
  survey.kind = ActionClass::Pure;
  survey.reads_world = true;
  survey.duration = 1s;
  const NodeId node = network.append(survey);
  ConcurrentEngineOptions options;
  options.speculate = false;
  EXPECT_EQ(simulate(network, options).nodes[index(node)].started, TimePoint(5s));
}

// "record" depends on nothing but what is beside the network, which "use" may still change.
TEST(Speculation, WhoReadsWhatIsBesideTheNetworkGivesBackWhatANodeBeforeItNeeds) {
  TaskNetwork network;
  const ResourceId arm = network.resources.intern("system:arm");
  NodeSpec use;
  use.preconditions = {{append_drive(network, 5s), true}};
  use.duration = 2s;
  use.claims = {{arm}};
  const NodeId first = network.append(use);
  NodeSpec record;
  record.kind = ActionClass::Pure;
  record.reads_beside = true;
  record.duration = 10s;
  record.claims = {{arm}};
  network.append(record);
  const RunResult result = simulate(network);
  EXPECT_EQ(result.nodes[index(first)].started, TimePoint(5s));
  EXPECT_EQ(result.statistics.preempted, 1U);
}

TEST(Speculation, WhoTakesUnitsInOrderIsCertainToCountWhileABranchInParallelGoesOn) {
  TaskNetwork network;
  NodeSpec drive;
  drive.duration = 5s;
  drive.parallel_branch = network.add_parallel_branch(kNone, 0);
  network.append(drive);
  const ResourceId cup = network.resources.intern("cup");
  network.resources[cup].varies = true;
  NodeSpec fill;
  fill.kind = ActionClass::Pure;
  fill.reads_beside = true;
  fill.duration = 1s;
  fill.claims = {{cup}};
  fill.parallel_branch = network.add_parallel_branch(kNone, 0);
  const NodeId node = network.append(fill);
  const RunResult result = simulate(network);
  EXPECT_EQ(result.nodes[index(node)].started, TimePoint(0s));
  EXPECT_EQ(result.statistics.speculative, 0U);
}

/// The changes of a run; `alive` until they are dropped. Those of the first run turn out to be invalid.
class Changes final : public PendingChanges {
 public:
  Changes(std::shared_ptr<const bool> alive, bool valid) : alive_(std::move(alive)), valid_(valid) {}
  [[nodiscard]] bool empty() const override { return false; }
  [[nodiscard]] bool valid() const override { return valid_; }
  Result<void> apply() override { return {}; }

 private:
  const std::shared_ptr<const bool> alive_;
  const bool valid_;
};

/// Runs of nodes that read what is beside the network end with changes, of which those of the first are
/// invalid.
class ChangingEnvironment final : public Environment {
 public:
  explicit ChangingEnvironment(const TaskNetwork& network) : network_(network) {}
  void start(NodeContext& context, Completions& completions) override {
    auto report = std::make_unique<Report>();
    if (network_[context.node()].reads_beside) {
      kept_at_start.push_back(!last_.expired());
      const auto alive = std::make_shared<const bool>(true);
      last_ = alive;
      report->pending = std::make_unique<Changes>(alive, context.attempt() > 1);
    }
    completions.finish_at(completions.now() + network_[context.node()].duration, context.node(),
                          context.attempt(), std::move(report));
  }
  void cancel(NodeId, std::uint32_t, Completions&) override {}
  std::vector<bool> kept_at_start;  ///< by run, whether the changes of the last one still existed

 private:
  const TaskNetwork& network_;
  std::weak_ptr<const bool> last_;
};

TEST(Speculation, WhatADiscardedRunHasChangedIsDroppedBeforeItsNodeRunsAgain) {
  TaskNetwork network;
  append_drive(network, 5s);
  NodeSpec record;
  record.kind = ActionClass::Pure;
  record.reads_beside = true;
  record.duration = 1s;
  network.append(record);
  const Order order = derive_order(network);
  ChangingEnvironment environment(network);
  ASSERT_TRUE(ConcurrentEngine(network, order, environment).run().done());
  EXPECT_THAT(environment.kept_at_start, testing::ElementsAre(false, false));
}

}  // namespace
}  // namespace segue::task_network

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

/// How many of `planners` run ahead while the robot still drives, with so many copies of the world. They rely
/// on where it drives to, or look at the whole world.
std::uint32_t running_ahead(std::uint32_t planners, std::uint32_t copies, bool reads_world = false) {
  TaskNetwork network;
  NodeSpec plan;
  plan.kind = ActionClass::Pure;
  const Literal there{append_drive(network, 10s), true};
  if (!reads_world) plan.preconditions = {there};
  plan.reads_world = reads_world;
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

TEST(Speculation, WhoLooksAtTheWholeWorldNeedsACopyToo) {
  EXPECT_EQ(running_ahead(5, 1, true), 1U);
  EXPECT_EQ(running_ahead(5, 4, true), 4U);
}

TEST(Speculation, InABranchWhoLooksAtTheWorldBeginsWithoutACopyOnceItIsReal) {
  TaskNetwork network;
  NodeSpec drive;
  drive.effects = {{*network.facts.intern("there()"), true}};
  drive.duration = 5s;
  drive.parallel_branch = network.add_parallel_branch(kNone, 0);
  network.append(drive);
  network.effects_are_declared = true;
  NodeSpec survey;
  survey.kind = ActionClass::Pure;
  survey.reads_world = true;
  survey.duration = 20s;
  survey.parallel_branch = network.add_parallel_branch(kNone, 0);
  network.append(survey);
  survey.parallel_branch = network.add_parallel_branch(kNone, 0);
  survey.duration = 1s;
  const NodeId second = network.append(survey);
  ConcurrentEngineOptions options;
  options.world_copies = 1;
  EXPECT_EQ(simulate(network, options).nodes[index(second)].started, TimePoint(5s));
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

/// When a node begins that takes what another one has made of the world, beside a node of ten seconds.
TimePoint begin_behind_reader(bool effects_are_declared, bool changes_something) {
  TaskNetwork network;
  network.effects_are_declared = effects_are_declared;
  NodeSpec slow;
  slow.duration = 10s;
  slow.parallel_branch = network.add_parallel_branch(kNone, 0);
  if (changes_something) slow.effects = {{*network.facts.intern("f()"), true}};
  network.append(slow);
  NodeSpec reader;
  reader.kind = ActionClass::Pure;
  reader.reads_world = true;
  reader.duration = 1s;
  reader.parallel_branch = network.add_parallel_branch(kNone, 0);
  NodeSpec user;
  user.parallel_branch = reader.parallel_branch;
  user.inputs = {{network.append(reader), 0, 0}};
  const NodeId node = network.append(user);
  return simulate(network).nodes[index(node)].started;
}

TEST(Speculation, WhoLooksAtTheWorldWaitsForWhatIsInParallelIfThatMayChangeIt) {
  EXPECT_EQ(begin_behind_reader(true, false), TimePoint(1s));
  EXPECT_EQ(begin_behind_reader(true, true), TimePoint(10s));
  EXPECT_EQ(begin_behind_reader(false, false), TimePoint(10s)) << "it may do what it does not declare";
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

/// A camera looks for ten seconds; then it counts what was planned for "nothing" or, as is expected and nine
/// times as likely, for "found". There is one planner, and each plan takes three seconds.
class LikelyBranches : public testing::Test {
 protected:
  LikelyBranches() {
    NodeSpec look;
    look.duration = 10s;
    look.branches = true;
    look_ = network_.append(look);
    for (auto* plans : {&for_nothing_, &for_found_}) {
      for (int i = 0; i < 2; ++i)
        plans->push_back(network_.append(plan(plans == &for_found_)));
    }
  }
  NodeSpec plan(bool found) {
    NodeSpec plan;
    plan.kind = ActionClass::Pure;
    plan.duration = 3s;
    plan.claims = {{network_.resources.intern("process:planner")}};
    const auto likelihood = static_cast<std::uint16_t>((found ? 0.9 : 0.1) * Condition::kCertain);
    plan.conditions = {{look_, found ? kSuccess : network_.outcome("nothing"), likelihood}};
    return plan;
  }
  static std::vector<TimePoint> starts(const RunResult& result, const std::vector<NodeId>& nodes) {
    std::vector<TimePoint> starts;
    for (const NodeId node : nodes)
      starts.push_back(result.nodes[index(node)].started);
    return starts;
  }

  TaskNetwork network_;
  NodeId look_{};
  std::vector<NodeId> for_nothing_;
  std::vector<NodeId> for_found_;
};

TEST_F(LikelyBranches, WhatIsLikelierToCountRunsAheadFirst) {
  const RunResult result = simulate(network_);
  EXPECT_THAT(starts(result, for_found_), testing::ElementsAre(TimePoint(0s), TimePoint(3s)));
  EXPECT_THAT(starts(result, for_nothing_), testing::ElementsAre(TimePoint(6s), TimePoint(9s)));
}

TEST_F(LikelyBranches, WhatIsLessLikelyThanAskedForWaitsUntilItCounts) {
  ConcurrentEngineOptions options;
  options.least_likelihood = 0.2;
  const RunResult result = simulate(network_, options);
  EXPECT_THAT(starts(result, for_found_), testing::ElementsAre(TimePoint(0s), TimePoint(3s)));
  EXPECT_EQ(result.statistics.wasted, 0U);
  EXPECT_EQ(result.statistics.speculative, 2U);
}

TEST_F(LikelyBranches, NoMoreRunAheadThanTheBudgetAllows) {
  network_.resources[*network_.resources.find("process:planner")].count = 4;
  ConcurrentEngineOptions options;
  EXPECT_EQ(simulate(network_, options).statistics.speculative, 4U) << "without a budget";
  options.ahead = 1;
  const RunResult result = simulate(network_, options);
  std::vector<TimePoint> all = starts(result, for_nothing_);
  for (const TimePoint start : starts(result, for_found_))
    all.push_back(start);
  std::ranges::sort(all);
  EXPECT_EQ(std::ranges::adjacent_find(all, [](TimePoint a, TimePoint b) { return b - a < 3s; }), all.end());
}

// Plans for a decision that falls at 30 s are likelier to count than those for the camera, until these are
// certain to count.
TEST_F(LikelyBranches, WhatHasBecomeCertainComesBeforeAllThatIsNot) {
  NodeSpec decide;
  decide.duration = 30s;
  decide.branches = true;
  const NodeId decision = network_.append(decide);
  NodeSpec far = plan(true);
  far.conditions = {{decision, kSuccess, Condition::kCertain - 1}};
  far.duration = 8s;
  const std::vector<NodeId> plans{network_.append(far), network_.append(far), network_.append(far)};
  const RunResult result = simulate(network_);
  EXPECT_THAT(starts(result, for_found_), testing::ElementsAre(TimePoint(10s), TimePoint(13s)));
  EXPECT_THAT(starts(result, plans), testing::ElementsAre(TimePoint(0s), TimePoint(16s), TimePoint(24s)));
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

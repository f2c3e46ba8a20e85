// SPDX-License-Identifier: Apache-2.0
#include <segue/task_network/acts_ahead.hpp>
#include <segue/task_network/concurrent_engine.hpp>
#include <segue/task_network/simulated_environment.hpp>

#include <gmock/gmock.h>

namespace segue::task_network {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class Ahead : public testing::Test {
 protected:
  /// A node that touches nothing unless `fact` is given, which it makes true.
  NodeSpec node(const std::string& name, const std::string& fact = "") {
    NodeSpec spec;
    spec.name = name;
    spec.duration = std::chrono::seconds(1);
    if (!fact.empty()) spec.effects.push_back({network_.facts.intern(fact).value(), true});
    return spec;
  }
  std::vector<NamedActsAhead> found() const {
    return by_name(network_, acts_ahead(network_, derive_order(network_), WholeNetwork(network_)));
  }
  static NamedActsAhead pair(std::string acts, std::vector<std::string> fails) {
    return {std::move(acts), std::move(fails)};
  }

  TaskNetwork network_;
};

TEST_F(Ahead, WhatDoesNotWaitForAnEarlierNodeMayHappenAlthoughThatFails) {
  network_.append(node("drive"));
  network_.append(node("unfold"));
  network_.append(node("wave"));
  EXPECT_THAT(found(), ElementsAre(pair("unfold", {"drive"}), pair("wave", {"drive", "unfold"})));
}

TEST_F(Ahead, WhatWaitsForAnEarlierNodeAlsoThroughOthersDoesNot) {
  network_.append(node("drive", "there()"));
  NodeSpec look = node("look", "seen()");
  look.preconditions.push_back({network_.facts.intern("there()").value(), true});
  network_.append(look);
  NodeSpec grasp = node("grasp");
  grasp.preconditions.push_back({network_.facts.intern("seen()").value(), true});
  network_.append(grasp);
  EXPECT_THAT(found(), IsEmpty());
}

TEST_F(Ahead, AResourceOrdersStartsOnly) {
  for (const char* name : {"open", "close"}) {
    NodeSpec spec = node(name);
    spec.claims.push_back({network_.resources.intern("two hands"), ResourceOp::Block, 1, kNone});
    network_.append(spec);
  }
  network_.resources[ResourceId{0}].count = 2;
  EXPECT_THAT(found(), ElementsAre(pair("close", {"open"})));
}

TEST_F(Ahead, WhoWaitsForAStrictNodeHasNotWaitedForWhatMayFailBesideThat) {
  NodeSpec look = node("look");
  look.parallel_branch = network_.add_parallel_branch(kNone, 0);
  network_.append(look);
  NodeSpec drive = node("drive", "there()");
  drive.parallel_branch = network_.add_parallel_branch(kNone, 0);
  drive.strict = true;
  network_.append(drive);
  NodeSpec grasp = node("grasp");
  grasp.preconditions.push_back({network_.facts.intern("there()").value(), true});
  network_.append(grasp);
  EXPECT_THAT(found(), ElementsAre(pair("grasp", {"look"})));
}

TEST_F(Ahead, PureNodesOnlyFailAndHandledAbortsEndNothing) {
  NodeSpec plan = node("plan");
  plan.kind = ActionClass::Pure;
  network_.append(plan);
  NodeSpec attempt = node("try");
  attempt.branches = attempt.handles_abort = true;
  network_.append(attempt);
  NodeSpec safe = node("safe");
  safe.cannot_fail = true;
  network_.append(safe);
  network_.append(plan);
  EXPECT_THAT(found(), ElementsAre(pair("try", {"plan"}), pair("safe", {"plan"})));
}

TEST_F(Ahead, NodesOnDifferentPathsNeverMeet) {
  NodeSpec choice = node("choice");
  choice.branches = true;
  const NodeId chosen = network_.append(choice);
  for (const char* name : {"left", "right"}) {
    NodeSpec spec = node(name);
    spec.conditions.push_back({chosen, network_.outcome(name)});
    network_.append(spec);
  }
  EXPECT_THAT(found(), IsEmpty());
}

TEST_F(Ahead, AStrictNodeWaitsAndSoDoesWhatWaitsForIt) {
  network_.append(node("drive"));
  NodeSpec unfold = node("unfold", "unfolded()");
  unfold.strict = true;
  network_.append(unfold);
  NodeSpec wave = node("wave");
  wave.preconditions.push_back({network_.facts.intern("unfolded()").value(), true});
  network_.append(wave);
  EXPECT_THAT(found(), IsEmpty());

  Trial fails;
  fails.outcome = kAborted;
  const std::vector<Trial> trials{fails, {}, {}};
  SimulatedEnvironment environment(network_, trials);
  const Order order = derive_order(network_);
  ConcurrentEngine engine(network_, order, environment, {});
  const RunResult result = engine.run();
  EXPECT_EQ(result.nodes[1].attempts, 0U) << "the strict node has begun";
}

class SensesAheadOf : public Ahead {
 protected:
  /// Senses; relies on the fact, if it is given.
  NodeSpec look(const std::string& fact = "") {
    NodeSpec spec = node("look");
    spec.kind = ActionClass::Sensing;
    if (!fact.empty()) spec.preconditions.push_back({network_.facts.intern(fact).value(), true});
    return spec;
  }
  std::vector<NamedSensesAhead> sensed() const {
    return by_name(network_, senses_ahead(network_, derive_order(network_), WholeNetwork(network_)));
  }
  static NamedSensesAhead before(std::vector<std::string> acts) { return {"look", std::move(acts)}; }
};

TEST_F(SensesAheadOf, WhoReliesOnNoFactOfADriveMaySenseBeforeIt) {
  network_.append(node("drive", "there()"));
  network_.append(look("warm()"));
  EXPECT_THAT(sensed(), ElementsAre(before({"drive"})));
}

TEST_F(SensesAheadOf, WhoReliesOnItsFactSensesAfterItAndAfterAllBeforeThat) {
  network_.append(node("plug", "plugged()"));
  NodeSpec drive = node("drive", "there()");
  drive.preconditions.push_back({network_.facts.intern("plugged()").value(), true});
  network_.append(drive);
  network_.append(look("there()"));
  EXPECT_THAT(sensed(), IsEmpty());
}

TEST_F(SensesAheadOf, ADecisionOrAPlanDoesNotKeepItFromSensing) {
  NodeSpec ask = node("ask", "asked()");
  ask.branches = true;
  const NodeId decides = network_.append(ask);
  NodeSpec plan = node("plan");
  plan.kind = ActionClass::Pure;
  plan.preconditions.push_back({network_.facts.intern("asked()").value(), true});
  const NodeId planned = network_.append(plan);
  NodeSpec spec = look();
  spec.conditions.push_back({decides, kSuccess});
  spec.inputs.push_back({planned, network_.names.intern("out"), network_.names.intern("in")});
  network_.append(spec);
  EXPECT_THAT(sensed(), ElementsAre(before({"ask"})));
}

TEST_F(SensesAheadOf, WhatRunsInParallelComesNeitherBeforeNorAfterIt) {
  NodeSpec drive = node("drive", "there()");
  drive.parallel_branch = network_.add_parallel_branch(kNone, 0);
  network_.append(drive);
  NodeSpec spec = look();
  spec.parallel_branch = network_.add_parallel_branch(kNone, 0);
  network_.append(spec);
  EXPECT_THAT(sensed(), IsEmpty());
}

}  // namespace
}  // namespace segue::task_network

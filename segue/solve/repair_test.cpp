// SPDX-License-Identifier: Apache-2.0
#include <segue/solve/repair.hpp>
#include <segue/solve/solve.hpp>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <support/random_transitions.hpp>
#include <support/strict_machine.hpp>

#include <set>

namespace segue::solve {
namespace {

using model::Action;
using model::Network;
using model::Transition;
using segue::testing::NetworkPair;
using segue::testing::random_pair;

/// A few tasks and processes of both networks, and some unknown ones.
RepairScope random_scope(const NetworkPair& pair, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  RepairScope scope;
  const auto one_in = [&](unsigned chances) { return random() % chances == 0; };
  for (const Network* network : {&pair.current, &pair.target}) {
    for (const model::Task& task : network->tasks) {
      if (one_in(4)) scope.tasks.push_back(task.id);
    }
    for (const model::Deployment& process : network->deployments) {
      if (one_in(8)) scope.processes.push_back(process.key());
    }
  }
  if (one_in(8)) scope.tasks.emplace_back("nobody");
  return scope;
}

RepairScope everything(const NetworkPair& pair) {
  RepairScope scope;
  for (const Network* network : {&pair.current, &pair.target}) {
    for (const model::Task& task : network->tasks)
      scope.tasks.push_back(task.id);
    for (const model::Deployment& process : network->deployments)
      scope.processes.push_back(process.key());
  }
  return scope;
}

Transition repaired(const NetworkPair& pair, const RepairScope& scope) {
  const auto found = repair(pair.current, pair.target, pair.catalog, {}, scope);
  if (!found) RC_FAIL(to_string(found.error()));
  return *found;
}

Network predicted(const NetworkPair& pair, const Transition& transition) {
  const auto found = predict(pair.current, transition, pair.catalog);
  if (!found) RC_FAIL(to_string(found.error()));
  return *found;
}

RC_GTEST_PROP(Repair, OfEverythingIsTheWholeTransition, (std::uint64_t seed)) {
  const NetworkPair pair = random_pair(seed);
  const Transition found = repaired(pair, everything(pair));
  RC_ASSERT(model::equivalent(predicted(pair, found), pair.target));
  const auto whole = diff(pair.current, pair.target, pair.catalog);
  RC_ASSERT(whole.has_value());
  RC_ASSERT(found.counts().by_kind == whole->counts().by_kind);
}

RC_GTEST_PROP(Repair, OfNothingIsEmpty, (std::uint64_t seed)) {
  const NetworkPair pair = random_pair(seed);
  const Transition found = repaired(pair, {});
  RC_ASSERT(found.actions.empty());
  RC_ASSERT(found.removes.empty());
  RC_ASSERT(found.redefines.empty());
}

/// Tasks of the scope get their desired form; all others stay as they are.
RC_GTEST_PROP(Repair, MendsTheScopeAndNothingElse, (std::uint64_t seed)) {
  const NetworkPair pair = random_pair(seed);
  const RepairScope asked = random_scope(pair, seed + 1);
  const RepairScope scope = widened(asked, pair.current, pair.target, pair.catalog);
  const Network after = predicted(pair, repaired(pair, asked));
  const std::set<model::TaskId> tasks(scope.tasks.begin(), scope.tasks.end());
  for (const Network* network : {&pair.current, &pair.target}) {
    for (const model::Task& task : network->tasks) {
      const Network& wanted = tasks.contains(task.id) ? pair.target : pair.current;
      const model::Task* now = after.find_task(task.id);
      const model::Task* then = wanted.find_task(task.id);
      RC_ASSERT((now == nullptr) == (then == nullptr));
      if (now != nullptr) RC_ASSERT(*now == *then);
    }
  }
}

RC_GTEST_PROP(Repair, LeavesConnectionsOfOthersAlone, (std::uint64_t seed)) {
  const NetworkPair pair = random_pair(seed);
  const RepairScope asked = random_scope(pair, seed + 1);
  const RepairScope scope = widened(asked, pair.current, pair.target, pair.catalog);
  const std::set<model::TaskId> tasks(scope.tasks.begin(), scope.tasks.end());
  for (const Action& action : repaired(pair, asked).actions) {
    if (const model::TaskId* task = action.task()) RC_ASSERT(tasks.contains(*task));
    if (const auto* what = std::get_if<model::ConnectionAction>(&action.what)) {
      const model::Connection& connection = what->connection;
      RC_ASSERT(tasks.contains(connection.from.task) || tasks.contains(connection.to.task));
    }
    if (const auto* what = std::get_if<model::DeploymentAction>(&action.what)) {
      const auto is_asked = std::find(scope.processes.begin(), scope.processes.end(), what->deployment.key());
      RC_ASSERT(action.kind == model::ActionKind::Deploy || is_asked != scope.processes.end());
    }
  }
}

RC_GTEST_PROP(Repair, BreaksNoRule, (std::uint64_t seed)) {
  const NetworkPair pair = random_pair(seed);
  const Transition found = repaired(pair, random_scope(pair, seed + 1));
  const Network target = predicted(pair, found);
  segue::testing::StrictMachine machine(pair.current, target, pair.catalog);
  for (const Action& action : found.actions) {
    const std::string broken = machine.execute(action);
    if (!broken.empty()) RC_FAIL(action.label() + ": " + broken);
  }
}

RC_GTEST_PROP(Repair, WidensOnce, (std::uint64_t seed)) {
  const NetworkPair pair = random_pair(seed);
  const RepairScope scope = widened(random_scope(pair, seed + 1), pair.current, pair.target, pair.catalog);
  RC_ASSERT(widened(scope, pair.current, pair.target, pair.catalog) == scope);
}

TEST(Repair, LeavesErrorsOutsideOfTheScope) {
  Network observed;
  for (const char* id : {"a", "b"}) {
    model::Task task;
    task.id = model::TaskId(id);
    task.component = model::ComponentName("demo::C");
    task.state = TaskState::Exception;
    observed.tasks.push_back(task);
  }
  Network belief = observed;
  for (model::Task& task : belief.tasks)
    task.state = TaskState::Running;
  const auto found = repair(observed, belief, {}, {}, {{model::TaskId("a")}, {}});
  ASSERT_TRUE(found) << to_string(found.error());
  std::vector<std::string> labels;
  for (const Action& action : found->actions)
    labels.push_back(action.label());
  EXPECT_EQ(labels, (std::vector<std::string>{"recover a", "configure a", "start a"}));
}

}  // namespace
}  // namespace segue::solve

// SPDX-License-Identifier: Apache-2.0
#include <segue/solve/solve.hpp>
#include <segue/solve/standby_network.hpp>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <support/random_transitions.hpp>

#include <set>

namespace segue::solve {
namespace {

using model::Action;
using model::ActionKind;
using model::Network;
using model::Transition;
using segue::testing::NetworkPair;
using segue::testing::random_pair;

/// A running network without errors, since there is no look-ahead with errors, and the wanted one.
NetworkPair quiet_pair(std::uint64_t seed) {
  segue::testing::PairShape shape;
  shape.errors = false;
  return random_pair(seed, shape);
}

Transition solved(const Network& from, const Network& to, const model::ComponentCatalog& catalog) {
  const auto found = diff(from, to, catalog);
  if (!found) RC_FAIL(to_string(found.error()));
  return *found;
}

RC_GTEST_PROP(LookAhead, PreparesAndTouchesNothing, (std::uint64_t seed)) {
  const NetworkPair pair = quiet_pair(seed);
  const Network standby = with_standby(pair.current, pair.target, pair.catalog);
  const Transition transition = solved(pair.current, standby, pair.catalog);
  RC_ASSERT(transition.removes.empty());
  RC_ASSERT(transition.redefines.empty());
  for (const Action& action : transition.actions) {
    RC_ASSERT(action.phase == model::Phase::Prepare);
    if (const model::TaskId* task = action.task()) RC_ASSERT(pair.current.find_task(*task) == nullptr);
    if (const auto* what = std::get_if<model::ConnectionAction>(&action.what)) {
      RC_ASSERT(pair.current.find_task(what->connection.from.task) == nullptr);
      RC_ASSERT(pair.current.find_task(what->connection.to.task) == nullptr);
    }
  }
  const auto reached = predict(pair.current, transition, pair.catalog);
  if (!reached) RC_FAIL(to_string(reached.error()));
  RC_ASSERT(model::equivalent(*reached, standby));
}

/// Checks that the transition from the standby network creates only parts that could not be prepared.
RC_GTEST_PROP(LookAhead, LeavesNothingThatCouldBePrepared, (std::uint64_t seed)) {
  const NetworkPair pair = quiet_pair(seed);
  const Network standby = with_standby(pair.current, pair.target, pair.catalog);
  const Transition cold = solved(pair.current, pair.target, pair.catalog);
  const Transition rest = solved(standby, pair.target, pair.catalog);
  const auto in_prepare = [](const Transition& transition) {
    std::multiset<std::string> labels;
    for (const Action& action : transition.actions) {
      if (action.phase == model::Phase::Prepare) labels.insert(action.label());
    }
    return labels;
  };
  // A prepared task can take over a state where one that is still to be configured could not.
  const auto count = [](const Transition& transition) {
    return transition.counts().total() - transition.counts().of(ActionKind::HandOver);
  };
  RC_CLASSIFY(count(rest) < count(cold));
  RC_ASSERT(count(rest) <= count(cold));
  for (const Action& action : rest.actions) {
    if (action.phase != model::Phase::Prepare) continue;
    // Only for tasks that move from where they run.
    const auto stands = [&](const model::TaskId& task) { return pair.current.find_task(task) != nullptr; };
    const auto* connection = std::get_if<model::ConnectionAction>(&action.what);
    if (connection != nullptr) {
      RC_ASSERT(stands(connection->connection.from.task) || stands(connection->connection.to.task));
    } else {
      RC_ASSERT(action.kind != ActionKind::Deploy);
      RC_ASSERT(stands(*action.task()));
    }
  }
  RC_ASSERT(in_prepare(rest).size() <= in_prepare(cold).size());
}

RC_GTEST_PROP(LookAhead, LeavesWhatRunsAsItIs, (std::uint64_t seed)) {
  const NetworkPair pair = quiet_pair(seed);
  Network standby = with_standby(pair.current, pair.target, pair.catalog);
  const auto is_extra = [&](const model::TaskId& task) { return pair.current.find_task(task) == nullptr; };
  std::erase_if(standby.tasks, [&](const model::Task& task) { return is_extra(task.id); });
  std::erase_if(standby.connections, [&](const model::Connection& connection) {
    return is_extra(connection.from.task) || is_extra(connection.to.task);
  });
  std::erase_if(standby.deployments, [&](const model::Deployment& process) {
    return std::none_of(pair.current.deployments.begin(), pair.current.deployments.end(),
                        [&](const model::Deployment& other) { return other.key() == process.key(); });
  });
  RC_ASSERT(model::equivalent(standby, pair.current));
  RC_ASSERT(standby.name == pair.current.name);
}

RC_GTEST_PROP(LookAhead, IsDoneOnce, (std::uint64_t seed)) {
  const NetworkPair pair = quiet_pair(seed);
  const Network standby = with_standby(pair.current, pair.target, pair.catalog);
  RC_ASSERT(model::equivalent(with_standby(standby, pair.target, pair.catalog), standby));
  RC_ASSERT(model::equivalent(with_standby(pair.target, pair.target, pair.catalog), pair.target));
}

RC_GTEST_PROP(LookAhead, CanBeGivenUp, (std::uint64_t seed)) {
  const NetworkPair pair = quiet_pair(seed);
  const Network standby = with_standby(pair.current, pair.target, pair.catalog);
  const Transition back = solved(standby, pair.current, pair.catalog);
  for (const Action& action : back.actions) {
    if (const model::TaskId* task = action.task()) RC_ASSERT(pair.current.find_task(*task) == nullptr);
  }
}

}  // namespace
}  // namespace segue::solve

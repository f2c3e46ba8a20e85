// SPDX-License-Identifier: Apache-2.0
#include <segue/solve/solve.hpp>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <support/random_transitions.hpp>
#include <support/strict_machine.hpp>

#include <map>
#include <queue>

/// Properties that every transition must have, on random pairs of networks with every feature.
namespace segue::solve {
namespace {

using model::Action;
using model::ActionKind;
using model::Order;
using model::Transition;
using segue::testing::NetworkPair;
using segue::testing::random_pair;
using segue::testing::StrictMachine;

Transition solve(const NetworkPair& pair, const Options& options) {
  auto found = diff(pair.current, pair.target, pair.catalog, options);
  RC_ASSERT(found.has_value());
  return *found;
}

Transition solve(const NetworkPair& pair, Order order) {
  return solve(pair, Options{order});
}

/// All options of the solver.
std::vector<Options> all_options() {
  std::vector<Options> all;
  for (const Order order : {Order::Seamless, Order::Paper}) {
    for (const bool side_by_side : {true, false}) {
      for (const bool force : {false, true})
        all.push_back({order, side_by_side, force});
    }
  }
  return all;
}

/// The network after the execution: the target.
void check_prediction(const NetworkPair& pair, const Options& options) {
  const Transition transition = solve(pair, options);
  const auto found = predict(pair.current, transition, pair.catalog);
  if (!found) RC_FAIL(to_string(found.error()));
  const auto differences = model::differences(*found, pair.target);
  if (!differences.empty()) RC_FAIL(differences.front());
  RC_ASSERT(model::equivalent(*found, pair.target));
}

RC_GTEST_PROP(TransitionProperties, LeadToTheTarget, (std::uint64_t seed)) {
  const NetworkPair pair = random_pair(seed);
  for (const Options& options : all_options())
    check_prediction(pair, options);
}

RC_GTEST_PROP(TransitionProperties, AreEmptyBetweenEqualNetworks, (std::uint64_t seed)) {
  NetworkPair pair = random_pair(seed);
  pair.current = pair.target;
  for (const Options& options : all_options()) {
    const Transition transition = solve(pair, options);
    RC_ASSERT(transition.actions.empty());
    RC_ASSERT(transition.removes.empty());
    RC_ASSERT(transition.redefines.empty());
  }
}

/// Hand-overs are ignored: they are not always possible, and never needed to reach the target.
std::multiset<std::string> labels(const Transition& transition) {
  std::multiset<std::string> found;
  for (const Action& action : transition.actions) {
    if (action.kind != ActionKind::HandOver) found.insert(action.label());
  }
  return found;
}

RC_GTEST_PROP(TransitionProperties, NeedTheSameActionsInBothOrders, (std::uint64_t seed)) {
  const NetworkPair pair = random_pair(seed);
  RC_ASSERT(labels(solve(pair, Order::Seamless)) == labels(solve(pair, Order::Paper)));
  RC_ASSERT(labels(solve(pair, Options{Order::Seamless, false})) == labels(solve(pair, Order::Paper)));
}

RC_GTEST_PROP(TransitionProperties, AreNumberedAndWaitOnlyForEarlierPhases, (std::uint64_t seed)) {
  const Transition transition =
      solve(random_pair(seed), Options{Order::Seamless, seed % 3 > 0, seed % 2 == 0});
  int id = 0;
  for (const Action& action : transition.actions) {
    RC_ASSERT(action.id == ++id);
    for (const int before : action.after) {
      RC_ASSERT(before >= 1 && before < id);
      RC_ASSERT(transition.actions[static_cast<std::size_t>(before - 1)].phase <= action.phase);
    }
    if (id > 1) RC_ASSERT(transition.actions[static_cast<std::size_t>(id - 2)].phase <= action.phase);
  }
}

RC_GTEST_PROP(TransitionProperties, FollowThePaperOneByOne, (std::uint64_t seed)) {
  const Transition transition = solve(random_pair(seed), Order::Paper);
  for (std::size_t i = 0; i < transition.actions.size(); ++i) {
    const Action& action = transition.actions[i];
    RC_ASSERT(action.after == (i == 0 ? std::vector<int>{} : std::vector<int>{static_cast<int>(i)}));
    if (i > 0) RC_ASSERT(transition.actions[i - 1].kind <= action.kind);
  }
}

/// A random order that `after` allows.
std::vector<const Action*> linearise(const Transition& transition, std::mt19937_64& random) {
  std::vector<const Action*> left;
  std::vector<const Action*> order;
  std::set<int> done;
  for (const Action& action : transition.actions)
    left.push_back(&action);
  while (!left.empty()) {
    std::vector<std::size_t> ready;
    for (std::size_t i = 0; i < left.size(); ++i) {
      const auto& after = left[i]->after;
      if (std::all_of(after.begin(), after.end(), [&](int id) { return done.contains(id); }))
        ready.push_back(i);
    }
    const std::size_t pick = ready[random() % ready.size()];
    order.push_back(left[pick]);
    done.insert(left[pick]->id);
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(pick));
  }
  return order;
}

void check_machine(const NetworkPair& pair, const Transition& transition,
                   const std::vector<const Action*>& order, bool side_by_side) {
  StrictMachine machine(pair.current, pair.target, pair.catalog, side_by_side);
  std::string story;
  for (const Action* action : order) {
    story += action->label() + "\n";
    const std::string broken = machine.execute(*action);
    if (!broken.empty()) RC_FAIL(story + "broke: " + broken);
  }
  const std::string difference = machine.finish(transition, pair.target);
  if (!difference.empty()) RC_FAIL(story + "left: " + difference);
}

RC_GTEST_PROP(TransitionProperties, BreakNoRuleInAnyOrderTheyAllow, (std::uint64_t seed)) {
  const NetworkPair pair = random_pair(seed);
  std::mt19937_64 random(seed + 1);
  for (const Options& options : all_options()) {
    const Transition transition = solve(pair, options);
    for (int i = 0; i < 3; ++i)
      check_machine(pair, transition, linearise(transition, random), options.side_by_side);
  }
}

/// Whether a task can take over the state of a removed one: they share nothing, and no constraint prevents
/// it.
RC_GTEST_PROP(TransitionProperties, HandOverWhatTasksRemember, (std::uint64_t seed)) {
  segue::testing::PairShape shape;
  shape.devices = false;
  shape.odd_names = false;
  shape.foreign = false;
  shape.same_processes = true;
  shape.errors = false;
  NetworkPair pair = random_pair(seed, shape);
  pair.catalog = {};
  const Transition transition = solve(pair, Order::Seamless);
  std::set<std::string> found;
  for (const Action& action : transition.actions) {
    if (action.kind == ActionKind::HandOver) found.insert(action.label());
  }
  RC_CLASSIFY(!found.empty());
  for (const model::Task& task : pair.target.tasks) {
    if (!task.takes_over || !is_configured(task.state)) continue;
    const model::Task* from = pair.current.find_task(*task.takes_over);
    const bool is_removed = from != nullptr && pair.target.find_task(from->id) == nullptr;
    const bool is_added = pair.current.find_task(task.id) == nullptr;
    if (!is_added || (from != nullptr && !is_removed)) continue;
    const bool expected = from != nullptr && is_configured(from->state);
    RC_ASSERT(found.contains("hand_over " + task.takes_over->str() + " -> " + task.id.str()) == expected);
  }
}

/// Force leaves out graceful actions, and nothing else.
RC_GTEST_PROP(TransitionProperties, DoNothingInProcessesThatTheyKill, (std::uint64_t seed)) {
  const NetworkPair pair = random_pair(seed);
  const Transition graceful = solve(pair, Order::Seamless);
  const Transition forced = solve(pair, Options{Order::Seamless, true, true});
  const auto more = labels(graceful);
  const auto less = labels(forced);
  RC_ASSERT(std::includes(more.begin(), more.end(), less.begin(), less.end()));
  std::vector<std::string> left_out;
  std::set_difference(more.begin(), more.end(), less.begin(), less.end(), std::back_inserter(left_out));
  for (const std::string& label : left_out) {
    const bool is_graceful = label.starts_with("stop ") || label.starts_with("cleanup ") ||
                             label.starts_with("recover ") || label.starts_with("disconnect ");
    RC_ASSERT(is_graceful);
  }
  for (const Action& action : forced.actions) {
    if (action.kind == ActionKind::Undeploy) RC_ASSERT(std::get<model::DeploymentAction>(action.what).kill);
  }
  for (const Action& action : graceful.actions) {
    if (action.kind == ActionKind::Undeploy) RC_ASSERT(!std::get<model::DeploymentAction>(action.what).kill);
  }
}

/// Tasks from which `to` can be reached along connections between members.
bool reaches(const std::multimap<std::string, std::string>& flow, const std::string& from,
             const std::string& to) {
  std::set<std::string> seen;
  std::queue<std::string> next;
  next.push(from);
  while (!next.empty()) {
    const std::string task = next.front();
    next.pop();
    if (task == to) return true;
    const auto [begin, end] = flow.equal_range(task);
    for (auto edge = begin; edge != end; ++edge) {
      if (seen.insert(edge->second).second) next.push(edge->second);
    }
  }
  return false;
}

/// Positions of the actions of a kind in the list, by task.
std::map<std::string, std::size_t> places(const std::vector<const Action*>& order, ActionKind kind) {
  std::map<std::string, std::size_t> found;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (order[i]->kind == kind) found[order[i]->task()->str()] = i;
  }
  return found;
}

/// The pairs of members with data flow between them, on connections that the transition neither makes nor
/// ends. (The paper's order considers all.)
std::multimap<std::string, std::string> flow_between(const std::vector<model::Connection>& connections,
                                                     const std::map<std::string, std::size_t>& members,
                                                     const Transition& transition, ActionKind change) {
  const auto is_changed = [&](const model::Connection& connection) {
    return transition.order == Order::Seamless &&
           std::any_of(transition.actions.begin(), transition.actions.end(), [&](const Action& action) {
             return action.kind == change &&
                    std::get<model::ConnectionAction>(action.what).connection == connection;
           });
  };
  std::multimap<std::string, std::string> flow;
  for (const auto& connection : connections) {
    if (is_changed(connection)) continue;
    const std::string from = connection.from.task.str();
    const std::string to = connection.to.task.str();
    if (from != to && members.contains(from) && members.contains(to)) flow.emplace(from, to);
  }
  return flow;
}

RC_GTEST_PROP(TransitionProperties, StopProducersFirstAndStartThemLast, (std::uint64_t seed)) {
  // Without errors all connections of the current network are there.
  segue::testing::PairShape shape;
  shape.errors = false;
  NetworkPair pair = random_pair(seed, shape);
  pair.catalog = {};
  std::mt19937_64 random(seed + 2);
  const Transition transition = solve(pair, seed % 2 == 0 ? Order::Seamless : Order::Paper);
  const auto order = linearise(transition, random);
  const auto stops = places(order, ActionKind::Stop);
  const auto starts = places(order, ActionKind::Start);
  const auto stopping = flow_between(pair.current.connections, stops, transition, ActionKind::Disconnect);
  const auto starting = flow_between(pair.target.connections, starts, transition, ActionKind::Connect);
  for (const auto& [from, to] : stopping) {
    if (!reaches(stopping, to, from)) RC_ASSERT(stops.at(from) < stops.at(to));
  }
  for (const auto& [from, to] : starting) {
    if (!reaches(starting, to, from)) RC_ASSERT(starts.at(to) < starts.at(from));
  }
}

/// Prepare must not touch the running network.
RC_GTEST_PROP(TransitionProperties, LeaveTheOldNetworkAloneInPrepare, (std::uint64_t seed)) {
  const NetworkPair pair = random_pair(seed);
  const Transition transition = solve(pair, Options{Order::Seamless, true, seed % 2 == 0});
  Transition first_half = transition;
  first_half.removes.clear();
  first_half.redefines.clear();
  std::erase_if(first_half.actions,
                [](const Action& action) { return action.phase != model::Phase::Prepare; });
  StrictMachine machine(pair.current, pair.target, pair.catalog);
  for (const Action& action : first_half.actions) {
    const std::string broken = machine.execute(action);
    if (!broken.empty()) RC_FAIL(action.label() + ": " + broken);
    const bool allowed = action.kind == ActionKind::Deploy || action.kind == ActionKind::ApplyConfig ||
                         action.kind == ActionKind::Configure || action.kind == ActionKind::Connect;
    RC_ASSERT(allowed);
  }
}

/// Whether the current incarnation of the task is not in the target.
bool goes(const model::TaskId& task, const Transition& transition) {
  const auto& removed = transition.removes;
  return std::find(removed.begin(), removed.end(), task) != removed.end() ||
         std::any_of(transition.actions.begin(), transition.actions.end(), [&](const Action& action) {
           return action.kind == ActionKind::ApplyConfig && *action.task() == task &&
                  action.phase != model::Phase::Retire;
         });
}

/// In retire the new network runs already: tasks of the target are in their states, and all their inputs are
/// connected. What stops then goes, or is not to run any more.
RC_GTEST_PROP(TransitionProperties, OnlyTidyUpInRetire, (std::uint64_t seed)) {
  const NetworkPair pair = random_pair(seed);
  const Transition transition = solve(pair, Order::Seamless);
  for (const Action& action : transition.actions) {
    if (action.phase != model::Phase::Retire) continue;
    const model::Task* wanted = action.task() == nullptr ? nullptr : pair.target.find_task(*action.task());
    const bool rests = wanted != nullptr && wanted->state != TaskState::Running;
    RC_ASSERT(action.kind == ActionKind::Recover || action.kind == ActionKind::Disconnect ||
              action.kind == ActionKind::Cleanup || action.kind == ActionKind::Undeploy ||
              (action.kind == ActionKind::Stop && (rests || goes(*action.task(), transition))));
  }
}

}  // namespace
}  // namespace segue::solve

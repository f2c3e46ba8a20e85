// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/supervisor.hpp>

#include <segue/base/text.hpp>
#include <segue/model/network_sets.hpp>
#include <segue/runtime/leftovers.hpp>
#include <segue/runtime/look_ahead.hpp>
#include <segue/runtime/robot_snapshot.hpp>

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

namespace segue::runtime::detail {

namespace {

/// Deadline of each action of a transition that was not requested.
constexpr Duration kActionDeadline = std::chrono::seconds(30);

/// Why nothing can be prepared while `controller` should run and `seen` was observed.
std::string drift_of(const model::Network& controller, const model::Network& seen) {
  const auto sentences = differences(controller, seen, 1);
  return "the running network has drifted from its controller" +
         (sentences.empty() ? std::string() : ": " + sentences.front());
}

std::vector<Readiness> unready(std::vector<Readiness> all, const std::string& reason) {
  for (auto& one : all) {
    one = {one.controller, false, 0, one.tasks, reason};
  }
  return all;
}

/// The result of a transition that was not requested, before it is executed.
SwitchResult unrequested_result(Cause cause, const model::NetworkName& from, const model::NetworkName& to) {
  SwitchResult result;
  result.cause = cause;
  result.who = "runtime";
  result.time = std::chrono::system_clock::now();
  result.from = from;
  result.to = to;
  return result;
}

/// Whether no action disturbs what runs.
bool only_prepares(const model::Transition& transition) {
  return std::ranges::none_of(
      transition.actions, [](const model::Action& action) { return action.phase == model::Phase::Commit; });
}

}  // namespace

Supervisor::Supervisor(RuntimeParts& parts, Switching& switching, const Halts& halts)
    : parts_(parts),
      switching_(switching),
      halts_(halts),
      repairs_(parts.options.policies.restart, AfterLimit::GiveUp),
      leftover_repairs_(parts.options.policies.restart, AfterLimit::GoOn),
      unseen_hosts_(unreachable_hosts(parts.host)) {}

TimePoint Supervisor::next() const {
  TimePoint next = next_observation_;
  for (const auto due : {repairs_.next(), leftover_repairs_.next(), parts_.pools.next()}) {
    if (due) {
      next = std::min(next, *due);
    }
  }
  return next;
}

void Supervisor::begin_anew() {
  repairs_.reset();
  leftover_repairs_.reset();
  unseen_hosts_.clear();
}

void Supervisor::host_returned(const model::HostName& host) {
  const Lock lock(mutex_);
  returned_hosts_.insert(host);
}

std::set<model::HostName> Supervisor::returned_hosts() const {
  const Lock lock(mutex_);
  return returned_hosts_;
}

void Supervisor::supervise() {
  const auto lost = unreachable_hosts(parts_.host);
  const auto returned =
      returned_hosts();  // the snapshot shows what these hold, but maybe not that of later ones
  const Observation seen = parts_.belief.observe();
  next_observation_ = RealClock::instance().now() + parts_.options.policies.watch;
  if (parts_.belief.is_assumed()) {
    return;
  }
  const auto held = parts_.belief.held();
  const bool is_current =
      parts_.belief.refresh(split_observation(seen.network, held.controller, held.wanted), seen);
  if (!is_current || unreachable_hosts(parts_.host) != lost) {
    parts_.queue
        .wake();  // the belief was replaced, or a host came or went: supervise again with a new snapshot
    return;
  }
  switching_.look_at_what_runs();
  switching_.note_differences(seen.network);
  forget_ended(seen.network);
  std::vector<UnresolvedFault> left;
  if (!parts_.host.loss()) {
    left = put_right(returned, seen);
  }
  // So that it is known since when something is wrong, also where nobody looks for a while.
  (void)judge({seen.network,
               parts_.pools.network().empty() ? std::vector<task_host::TaskReport>() : parts_.host.tasks(),
               {}});
  parts_.faults.set_unresolved(std::move(left));
  // An action left in progress may prepare just what look-ahead would; its end wakes this thread.
  if (!parts_.queue.left_actions()->any() && parts_.standby_requests.take_due() &&
      !parts_.queue.has_request()) {
    look_ahead();
  }
}

std::vector<UnresolvedFault> Supervisor::put_right(const std::set<model::HostName>& returned,
                                                   const Observation& seen) {
  bring_back(returned, seen);
  auto left = handle_faults(seen);
  auto leftovers = collect_leftovers(seen);
  // An action left in progress may be about an instance; its end wakes this thread.
  if (!parts_.queue.left_actions()->any()) {
    parts_.pools.look_after(
        [this](const Observation& now, const solve::RepairScope& scope, const model::Network& pools_part,
               bool force) { return repair(Cause::Pool, now, scope, pools_part, force); });
  }
  left.insert(left.end(), std::make_move_iterator(leftovers.begin()),
              std::make_move_iterator(leftovers.end()));
  return left;
}

void Supervisor::forget_ended(const model::Network& observed) {
  const model::Network desired = parts_.belief.held().desired();
  std::set<model::DeploymentKey> missing;
  const model::Network pools = parts_.pools.wanted();
  for (const auto* network : {&desired, &pools}) {
    for (const auto& deployment : network->deployments) {
      missing.insert(deployment.key());
    }
  }
  for (const auto& deployment : observed.deployments) {
    missing.erase(deployment.key());
  }
  parts_.faults.forget_ended_but(missing);
}

/// A computer that was away runs what it ran then, or less, whatever has been requested meanwhile. One that
/// was away since the start holds its part of what ran before it, as long as nothing else was requested.
void Supervisor::bring_back(const std::set<model::HostName>& hosts, const Observation& seen) {
  bool is_first_seen = false;
  {
    const Lock lock(mutex_);
    for (const auto& returned : hosts) {
      returned_hosts_.erase(returned);
      is_first_seen = unseen_hosts_.erase(returned) > 0 || is_first_seen;
    }
  }
  if (is_first_seen) {
    return switching_.reset({});
  }
  const auto held = parts_.belief.held();
  if (hosts.empty() || !held.wanted) {
    return;
  }
  solve::RepairScope scope;
  for (const auto* network : {&*held.wanted, &seen.network}) {
    for (const auto& deployment : network->deployments) {
      if (!hosts.contains(deployment.host)) {
        continue;
      }
      scope.processes.push_back(deployment.key());
      for (const auto& placement : deployment.tasks) {
        scope.tasks.push_back(placement.task);
      }
    }
  }
  repair(Cause::Repair, seen, scope, parts_.pools.part(seen.network));
}

void Supervisor::fall_back(const Observation& seen) {
  const auto held = parts_.belief.held();
  const auto fallback = parts_.controllers.fallback();
  if (!fallback || fallback->name == held.controller.name || halts_.refusal()) {
    return;  // its differences have been reported
  }
  const auto plan = plan_network(seen.network, *fallback, {{}, parts_.pools.part(seen.network)}, parts_.host,
                                 parts_.catalog, solve_options(parts_.host, model::Order::Seamless, false));
  if (!plan) {
    parts_.log.add(EventKind::TransitionFailed, fallback->name.str(), to_string(plan.error()));
    return;
  }
  switching_.run_if_idle([&](RuntimeState before) {
    SwitchResult result = unrequested_result(Cause::Fallback, held.controller.name, fallback->name);
    switching_.carry_out(seen.network, *plan, kActionDeadline, result);
    parts_.history.add(result);
    // Where it failed, what has been restored has the faults for which it was to run.
    return result.outcome == Outcome::Failed ? RuntimeState::Failed : state_after(result, before);
  });
}

/// Tasks and processes that could not be retired, or that a superseded request prepared.
std::vector<DetectedFault> Supervisor::leftovers() const {
  const model::Network extra = parts_.belief.held().extra;
  const model::Network left =
      model::subtract(parts_.pools.is_kept() ? parts_.pools.without(extra) : extra, switching_.standby());
  std::vector<DetectedFault> faults;
  for (const auto& task : left.tasks) {
    faults.push_back({task.id, model::FailurePolicy::Restart, "was left over", false});
  }
  for (const auto& deployment : left.deployments) {
    faults.push_back({deployment.key(), model::FailurePolicy::Restart, "was left over", true});
  }
  return faults;
}

/// Those of which an action is still in progress would hold it up, and requests with it.
std::vector<UnresolvedFault> Supervisor::collect_leftovers(const Observation& seen) {
  if (parts_.queue.left_actions()->any()) {
    return {};
  }
  const auto faults = leftovers();
  const auto decision = leftover_repairs_.decide(faults, RealClock::instance().now());
  for (const auto& fault : decision.given_up) {
    parts_.log.add(EventKind::GivenUp, fault.name(),
                   fault.symptom + " and is there still, after " +
                       std::to_string(leftover_repairs_.attempts(fault)) +
                       " attempts to remove it; further attempts follow at longer intervals");
  }
  if (!decision.repair.empty()) {
    repair(Cause::Collect, seen, scope_of(decision.repair), parts_.pools.part(seen.network));
  }
  std::vector<UnresolvedFault> unremoved;
  for (const auto& fault : leftover_repairs_.exhausted(faults)) {
    unremoved.push_back({sentence_of(fault, leftover_repairs_)});
  }
  return unremoved;
}

bool Supervisor::repair(Cause cause, const Observation& seen, const solve::RepairScope& scope,
                        const model::Network& pools_part, bool force) {
  const auto held = parts_.belief.held();
  SwitchPlan plan;
  plan.controller = held.wanted.value_or(held.controller);
  plan.lost = unreachable_hosts(parts_.host);
  plan.target = model::without_hosts(
      model::unite(model::unite(plan.controller, switching_.standby()), pools_part), plan.lost);
  auto transition = solve::repair(seen.network, plan.target, parts_.catalog,
                                  solve_options(parts_.host, model::Order::Seamless, force), scope);
  if (!transition) {
    parts_.log.add(EventKind::TransitionFailed, plan.controller.name.str(), to_string(transition.error()));
    return false;
  }
  if (transition->actions.empty() && transition->removes.empty()) {
    return true;
  }
  plan.transition = std::move(*transition);
  bool done = false;
  switching_.run_if_idle([&](RuntimeState before) {
    SwitchResult result = unrequested_result(cause, held.controller.name, plan.controller.name);
    switching_.carry_out(seen.network, plan, kActionDeadline, result);
    done = result.ok();
    parts_.history.add(std::move(result));
    return before;
  });
  return done;
}

void Supervisor::look_ahead() {
  const auto held = parts_.belief.held();
  SwitchPlan plan;
  plan.controller = held.wanted.value_or(held.controller);
  auto ahead = parts_.standby_requests.plan(plan.controller);
  if (const auto lost = parts_.refusal_of_lost_robot()) {
    return parts_.standby_requests.answer(unready(std::move(ahead.readiness), to_string(*lost)));
  }
  const Observation seen = parts_.belief.starting_point();
  plan.lost = unreachable_hosts(parts_.host);
  plan.target = model::without_hosts(
      model::unite(with_properties_of(seen.network, plan.controller), ahead.standby), plan.lost);
  plan.target = model::unite(std::move(plan.target), parts_.pools.part(seen.network));
  auto how = solve_options(parts_.host, model::Order::Seamless, false);
  how.idle = idle_tasks(seen.network, held.controller);
  auto transition = solve_from_observed(seen.network, plan.target, parts_.catalog, std::move(how));
  if (!transition) {
    ahead.readiness = unready(std::move(ahead.readiness), to_string(transition.error()));
  } else if (!only_prepares(*transition)) {
    ahead.readiness = unready(std::move(ahead.readiness), drift_of(plan.controller, seen.network));
  } else if (!transition->actions.empty()) {
    plan.transition = std::move(*transition);
    prepare(seen, plan, ahead);
  }
  parts_.standby_requests.answer(std::move(ahead.readiness));
}

void Supervisor::prepare(const Observation& seen, const SwitchPlan& plan, LookAheadPlan& ahead) {
  const auto runs = parts_.belief.held().controller.name;
  switching_.run_if_idle([&](RuntimeState before) {
    SwitchResult result = unrequested_result(Cause::LookAhead, runs, plan.controller.name);
    switching_.carry_out(seen.network, plan, kActionDeadline, result);
    for (auto& one : ahead.readiness) {
      if (!result.ok())
        one = {one.controller, false, 0, one.tasks, result.why()};
      else if (const auto wished =
                   one.prepared > 0 ? parts_.controllers.expanded(one.controller) : std::nullopt)
        parts_.host.get_ready(*wished);
    }
    parts_.history.add(std::move(result));
    return before;
  });
}

}  // namespace segue::runtime::detail

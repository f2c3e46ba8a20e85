// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/model/network_sets.hpp>
#include <segue/runtime/leftovers.hpp>
#include <segue/runtime/runtime_implementation.hpp>

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <utility>

namespace segue::runtime {

using detail::DetectedFault;
using detail::Observation;
using detail::scope_of;
using detail::sentence_of;
using detail::SwitchPlan;

namespace {

/// Deadline of each action of a transition that was not requested.
constexpr Duration kActionDeadline = std::chrono::seconds(30);

/// Resident memory of a process in bytes; 0 if there is no such process.
std::uint64_t resident(int pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/statm");
  std::uint64_t size = 0;
  std::uint64_t pages = 0;
  file >> size >> pages;
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

detail::MemoryOf memory_of(const task_host::TaskHost& host) {
  std::map<model::DeploymentKey, int> pids;
  const bool alone = host.computers().empty();
  for (const auto& task : host.tasks()) {
    if (alone || task.process.host == model::kLocalHost) {  // other computers count their own
      pids.emplace(task.process, task.pid);
    }
  }
  return [pids = std::move(pids)](const model::DeploymentKey& process) {
    const auto found = pids.find(process);
    return found == pids.end() ? 0 : resident(found->second);
  };
}

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

}  // namespace

TimePoint Runtime::Implementation::next_supervision() const {
  TimePoint next = next_observation;
  for (const auto* one : {&repairs, &leftover_repairs, &pool_repairs}) {
    if (const auto due = one->next()) {
      next = std::min(next, *due);
    }
  }
  return next;
}

void Runtime::Implementation::supervise() {
  const auto lost = detail::unreachable_hosts(host);
  std::set<model::HostName> returned;
  {
    const Lock lock(mutex);
    returned = returned_hosts;  // the snapshot shows what these hold, but maybe not that of later ones
  }
  const Observation seen = belief.observe();
  next_observation = RealClock::instance().now() + options.policies.watch;
  if (belief.is_assumed()) {
    return;
  }
  const auto held = belief.held();
  const bool is_current =
      belief.refresh(detail::split_observation(seen.network, held.controller, held.wanted), seen);
  if (!is_current || detail::unreachable_hosts(host) != lost) {
    wake_worker();  // the belief was replaced, or a host came or went: supervise again with a new snapshot
    return;
  }
  look_at_what_runs();
  note_differences(seen.network);
  forget_ended(seen.network);
  std::vector<UnresolvedFault> left;
  if (!host.loss()) {
    left = put_right(returned, seen);
  }
  // So that it is known since when something is wrong, also where nobody looks for a while.
  judge({seen.network, pools.empty() ? std::vector<task_host::TaskReport>() : host.tasks(), {}});
  bool due = false;
  {
    const Lock lock(mutex);
    const bool has_any = !unresolved.empty() || !left.empty();
    unresolved = std::move(left);
    if (has_any) {
      changes.add();
    }
    // What is left in progress may be just what is to be prepared; its end wakes this thread.
    due = !left_actions->any() && std::exchange(look_ahead_due, false) && !waiting;
  }
  if (due) {
    look_ahead();
  }
}

std::vector<UnresolvedFault> Runtime::Implementation::put_right(const std::set<model::HostName>& returned,
                                                                const Observation& seen) {
  bring_back(returned, seen);
  auto left = handle_faults(seen);
  auto leftovers = collect_leftovers(seen);
  look_after_pools();
  left.insert(left.end(), std::make_move_iterator(leftovers.begin()),
              std::make_move_iterator(leftovers.end()));
  return left;
}

void Runtime::Implementation::forget_ended(const model::Network& observed) {
  const model::Network desired = belief.held().desired();
  std::set<model::DeploymentKey> missing;
  for (const auto* network : {&desired, &pools}) {
    for (const auto& deployment : network->deployments) {
      missing.insert(deployment.key());
    }
  }
  for (const auto& deployment : observed.deployments) {
    missing.erase(deployment.key());
  }
  const Lock lock(mutex);
  std::erase_if(ended, [&](const auto& entry) { return !missing.contains(entry.first); });
}

/// A computer that was away runs what it ran then, or less, whatever has been requested meanwhile. One that
/// was away since the start holds its part of what ran before it, as long as nothing else was requested.
void Runtime::Implementation::bring_back(const std::set<model::HostName>& hosts, const Observation& seen) {
  bool is_first_seen = false;
  {
    const Lock lock(mutex);
    for (const auto& returned : hosts) {
      returned_hosts.erase(returned);
      is_first_seen = unseen_hosts.erase(returned) > 0 || is_first_seen;
    }
  }
  if (is_first_seen) {
    return reset({});
  }
  const auto held = belief.held();
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
  repair(Cause::Repair, seen, scope, pool_part(seen.network));
}

void Runtime::Implementation::fall_back(const Observation& seen) {
  const auto held = belief.held();
  const auto fallback = this->fallback();
  if (!fallback || fallback->name == held.controller.name || halts.refusal()) {
    return;  // its differences have been reported
  }
  const auto plan = detail::plan_network(seen.network, *fallback, {{}, pool_part(seen.network)}, host,
                                         catalog, detail::solve_options(host, model::Order::Seamless, false));
  if (!plan) {
    log.add(EventKind::TransitionFailed, fallback->name.str(), to_string(plan.error().error));
    return;
  }
  run_if_idle([&](RuntimeState) {
    SwitchResult result = unrequested_result(Cause::Fallback, held.controller.name, fallback->name);
    carry_out(seen.network, *plan, kActionDeadline, result);
    remember(result);
    return result.outcome == Outcome::Failed ? RuntimeState::Failed : RuntimeState::Idle;
  });
}

/// Removes leftovers: tasks and processes that could not be retired, or that a superseded request prepared.
/// Those of which an action is still in progress would hold it up, and requests with it.
std::vector<UnresolvedFault> Runtime::Implementation::collect_leftovers(const Observation& seen) {
  if (left_actions->any()) {
    return {};
  }
  const model::Network extra = belief.held().extra;
  const model::Network left = model::subtract(pools_run ? without_pools(extra) : extra, standby);
  std::vector<DetectedFault> faults;
  for (const auto& task : left.tasks) {
    faults.push_back({task.id, model::FailurePolicy::Restart, "was left over", false});
  }
  for (const auto& deployment : left.deployments) {
    faults.push_back({deployment.key(), model::FailurePolicy::Restart, "was left over", true});
  }
  const auto decision = leftover_repairs.decide(faults, RealClock::instance().now());
  for (const auto& fault : decision.given_up) {
    log.add(EventKind::GivenUp, fault.name(),
            fault.symptom + " and is there still, after " + std::to_string(leftover_repairs.attempts(fault)) +
                " attempts to remove it; further attempts follow at longer intervals");
  }
  if (!decision.repair.empty()) {
    repair(Cause::Collect, seen, scope_of(decision.repair), pool_part(seen.network));
  }
  std::vector<UnresolvedFault> unremoved;
  for (const auto& fault : leftover_repairs.exhausted(faults)) {
    unremoved.push_back({sentence_of(fault, leftover_repairs)});
  }
  return unremoved;
}

bool Runtime::Implementation::repair(Cause cause, const Observation& seen, const solve::RepairScope& scope,
                                     const model::Network& pools_part, bool force) {
  const auto held = belief.held();
  SwitchPlan plan;
  plan.controller = held.wanted.value_or(held.controller);
  plan.lost = detail::unreachable_hosts(host);
  plan.target =
      model::without_hosts(model::unite(model::unite(plan.controller, standby), pools_part), plan.lost);
  auto transition = solve::repair(seen.network, plan.target, catalog,
                                  detail::solve_options(host, model::Order::Seamless, force), scope);
  if (!transition) {
    log.add(EventKind::TransitionFailed, plan.controller.name.str(), to_string(transition.error()));
    return false;
  }
  if (transition->actions.empty() && transition->removes.empty()) {
    return true;
  }
  plan.transition = std::move(*transition);
  bool done = false;
  run_if_idle([&](RuntimeState before) {
    SwitchResult result = unrequested_result(cause, held.controller.name, plan.controller.name);
    carry_out(seen.network, plan, kActionDeadline, result);
    done = result.outcome == Outcome::Done;
    remember(result);
    return before;
  });
  return done;
}

std::vector<detail::PrepareRequest> Runtime::Implementation::known_prepare_requests(
    const model::Network& controller) const {
  std::vector<model::NetworkName> names;
  std::shared_ptr<const model::Halt> halt;
  {
    const Lock lock(mutex);
    if (!leases.refusal_of(prepare_lease)) {
      names = requests_to_prepare;
    }
    halt = controller.empty() ? nullptr : definitions.halt;  // what runs nothing is at rest
  }
  std::vector<detail::PrepareRequest> all;
  if (auto rest = halt ? expanded(known(halt->controller)) : std::nullopt) {
    all.push_back({halt->controller, std::move(rest), true});
  }
  for (auto& wanted : names) {
    all.push_back({wanted, expanded(known(wanted))});
  }
  return all;
}

detail::LookAheadPlan Runtime::Implementation::plan_ahead(const model::Network& controller) const {
  const auto all = known_prepare_requests(controller);
  if (all.empty()) {
    return {};
  }
  return detail::look_ahead(controller, all, catalog, options.look_ahead, memory_of(host));
}

bool Runtime::Implementation::looks_ahead() const {
  return !requests_to_prepare.empty() || prepare_waiting || definitions.halt;
}

void Runtime::Implementation::look_ahead() {
  const auto held = belief.held();
  SwitchPlan plan;
  plan.controller = held.wanted.value_or(held.controller);
  auto ahead = plan_ahead(plan.controller);
  if (const auto lost = refusal_of_lost_robot()) {
    return answer_prepare(unready(std::move(ahead.readiness), to_string(*lost)));
  }
  const Observation seen = belief.starting_point();
  plan.lost = detail::unreachable_hosts(host);
  plan.target = model::without_hosts(
      model::unite(detail::with_properties_of(seen.network, plan.controller), ahead.standby), plan.lost);
  plan.target = model::unite(std::move(plan.target), pool_part(seen.network));
  auto how = detail::solve_options(host, model::Order::Seamless, false);
  how.idle = detail::idle_tasks(seen.network, held.controller);
  auto transition = detail::solve_from_observed(seen.network, plan.target, catalog, std::move(how));
  // Look-ahead must not touch the running controller: no action of the commit phase is allowed.
  const bool harmless = transition && std::none_of(transition->actions.begin(), transition->actions.end(),
                                                   [](const model::Action& action) {
                                                     return action.phase == model::Phase::Commit;
                                                   });
  if (harmless && !transition->actions.empty()) {
    plan.transition = std::move(*transition);
    run_if_idle([&](RuntimeState before) {
      SwitchResult result = unrequested_result(Cause::LookAhead, held.controller.name, plan.controller.name);
      carry_out(seen.network, plan, kActionDeadline, result);
      for (auto& one : ahead.readiness) {
        if (result.outcome != Outcome::Done)
          one = {one.controller, false, 0, one.tasks, result.error ? to_string(*result.error) : ""};
        else if (const auto wished = one.prepared > 0 ? expanded(known(one.controller)) : std::nullopt)
          host.get_ready(*wished);
      }
      remember(std::move(result));
      return before;
    });
  } else if (!harmless) {
    const std::string reason =
        transition ? drift_of(plan.controller, seen.network) : to_string(transition.error());
    ahead.readiness = unready(std::move(ahead.readiness), reason);
  }
  answer_prepare(std::move(ahead.readiness));
}

std::future<std::vector<Readiness>> Runtime::Implementation::prepare(std::vector<model::NetworkName> wanted,
                                                                     std::uint64_t lease) {
  std::optional<std::promise<std::vector<Readiness>>> older;
  std::future<std::vector<Readiness>> future;
  std::vector<Readiness> last;
  {
    const Lock lock(mutex);
    if (leases.refusal_of(lease)) {
      std::promise<std::vector<Readiness>> nothing;
      nothing.set_value({});
      return nothing.get_future();
    }
    older.swap(prepare_waiting);
    requests_to_prepare = std::move(wanted);
    prepare_lease = lease;
    prepare_waiting.emplace();
    future = prepare_waiting->get_future();
    look_ahead_due = true;
    wake_requested = true;
    last = readiness;
  }
  wake.notify_all();
  if (older) {
    older->set_value(std::move(last));
  }
  return future;
}

void Runtime::Implementation::answer_prepare(std::vector<Readiness> answer) {
  std::optional<std::promise<std::vector<Readiness>>> asked;
  {
    const Lock lock(mutex);
    readiness = answer;
    asked.swap(prepare_waiting);
  }
  for (const auto& one : answer) {
    log.add(EventKind::Prepared, one.controller.str(),
            one.ready ? std::to_string(one.prepared) + " of " + std::to_string(one.tasks) + " tasks are ready"
                      : one.reason);
  }
  if (asked) {
    asked->set_value(std::move(answer));
  }
}

}  // namespace segue::runtime

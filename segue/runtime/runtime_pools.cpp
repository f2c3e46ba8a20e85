// SPDX-License-Identifier: Apache-2.0
#include <segue/model/network_sets.hpp>
#include <segue/model/pools.hpp>
#include <segue/runtime/runtime_implementation.hpp>

#include <unistd.h>

#include <algorithm>
#include <utility>

/// Pools are not part of what is requested. Whatever of them is there stays as it is in each transition
/// (KeptNetworks::pools), so no switch waits for an instance, or fails with one; starting them is the
/// business of supervision alone.
namespace segue::runtime {

using detail::DetectedFault;
using detail::Observation;

namespace {

/// The instance that a fault concerns: its process has the name of its task.
model::TaskId instance_of(const DetectedFault& fault) {
  const auto* task = std::get_if<model::TaskId>(&fault.subject);
  return task != nullptr ? *task : model::TaskId(std::get<model::DeploymentKey>(fault.subject).process.str());
}

/// The network of one instance.
model::Network only(const model::TaskId& instance, const model::Network& pools) {
  model::Network one;
  std::ranges::copy_if(pools.tasks, std::back_inserter(one.tasks),
                       [&](const model::Task& task) { return task.id == instance; });
  std::ranges::copy_if(pools.deployments, std::back_inserter(one.deployments),
                       [&](const auto& deployment) { return deployment.process.str() == instance.str(); });
  return one;
}

/// One that only reports, or that shall keep its process, is left as it is once it has run.
bool is_left_alone(const DetectedFault& fault) {
  return fault.policy == model::FailurePolicy::Report ||
         (fault.policy == model::FailurePolicy::Recover && fault.needs_process);
}

}  // namespace

model::Network Runtime::Implementation::pool_part(const model::Network& network) const {
  return pools_run && !pools.empty() ? model::subtract(network, model::subtract(network, pools))
                                     : model::Network{};
}

model::Network Runtime::Implementation::without_pools(const model::Network& network) const {
  if (pools.empty()) {
    return network;
  }
  model::Network rest = model::subtract(network, pools);
  rest.name = network.name;
  return rest;
}

std::optional<detail::Refusal> Runtime::Implementation::refusal_for_pools(
    const model::Network& network) const {
  Diagnostics findings;
  model::detail::check_pools(options.pools, network, findings);
  if (!findings.has_errors()) {
    return std::nullopt;
  }
  Error error = findings.to_error();
  return detail::Refusal{std::move(error), std::move(findings)};
}

std::vector<DetectedFault> Runtime::Implementation::find_pool_faults() {
  const Observation seen = belief.observe();
  for (const auto& task : pool_part(seen.network).tasks) {
    if (task.state == TaskState::Running) {
      pool_instances_seen.insert(task.id);
    }
  }
  auto faults =
      detail::find_faults(detail::reachable_part(pools, host), seen.network, model::FailurePolicy::Report);
  for (DetectedFault& fault : faults) {
    if (!pool_instances_seen.contains(instance_of(fault))) {
      fault.policy = model::FailurePolicy::Restart;  // whatever shall happen when it fails, it begins
      fault.symptom = "has not been started yet";
    }
  }
  return faults;
}

void Runtime::Implementation::look_after_pools() {
  if (pools.empty() || !pools_run) {
    return;
  }
  {
    const Lock lock(mutex);
    if (std::exchange(pools_begin_again, false)) {
      pool_repairs.reset();
      pool_instances_seen.clear();
    }
  }
  for (const auto& [life, why] : instance_calls.abandoned()) {
    start_instance({life.instance, model::FailurePolicy::Restart, why, true});
    // In the process of the runtime the same one is made anew, since that cannot be ended.
    if (life.pid == ::getpid()) {
      instance_calls.forget(life);
    }
  }
  const auto faults = find_pool_faults();
  std::vector<DetectedFault> to_start;
  std::ranges::remove_copy_if(faults, std::back_inserter(to_start), is_left_alone);
  const auto decision = pool_repairs.decide(to_start, RealClock::instance().now());
  for (const auto& fault : decision.given_up) {
    log.add(EventKind::GivenUp, fault.name(),
            fault.symptom + ", after " + std::to_string(pool_repairs.attempts(fault)) +
                " attempts to start it; further attempts follow at longer intervals");
  }
  for (const auto& fault : decision.repair) {
    start_instance(fault);
  }
  note_pool_faults(decision.repair.empty() ? faults : find_pool_faults());
}

void Runtime::Implementation::start_instance(const DetectedFault& fault) {
  Observation seen = belief.observe();
  const model::TaskId instance = instance_of(fault);
  for (model::Task& task : seen.network.tasks) {
    if (task.id == instance && fault.needs_process) {
      task.state = TaskState::Fatal;  // whatever it says: its process is to be replaced
    }
  }
  solve::RepairScope scope;
  if (const auto* process = std::get_if<model::DeploymentKey>(&fault.subject)) {
    scope.processes.push_back(*process);
  } else {
    scope.tasks.push_back(instance);
  }
  log.add(EventKind::Repair, instance.str(), fault.name() + " " + fault.symptom);
  if (pool_instances_seen.contains(instance)) {
    journal.drifted(fault.name(), fault.name() + " " + fault.symptom, "repaired");
  }
  instance_calls.starts(instance);
  // What an instance carries out cannot be interrupted, so a process that is to be replaced is killed.
  const auto part = model::unite(only(instance, pools), pool_part(seen.network));
  if (repair(Cause::Pool, seen, scope, part, fault.needs_process)) {
    pool_instances_seen.insert(instance);  // also where it has failed before it is looked at again
  }
}

void Runtime::Implementation::note_pool_faults(const std::vector<DetectedFault>& faults) {
  const Lock lock(mutex);
  pool_faults.clear();
  for (const auto& fault : faults) {
    std::string why = fault.symptom;
    if (const auto* process = std::get_if<model::DeploymentKey>(&fault.subject)) {
      const auto found = ended.find(*process);
      why.insert(0, "its process ");
      if (found != ended.end()) why.append(" (").append(found->second).append(")");
    }
    if (is_left_alone(fault)) {
      why += ", and is left so, as its 'on_failure' says";
    } else if (const int attempts = pool_repairs.attempts(fault); attempts > 0) {
      why += "; " + std::to_string(attempts) + (attempts == 1 ? " attempt" : " attempts") +
             " to start it have not helped";
    }
    const bool given_up =
        is_left_alone(fault) || pool_repairs.attempts(fault) >= options.policies.restart.max;
    const model::TaskId instance = instance_of(fault);
    pool_faults.insert_or_assign(instance, PoolInstance{instance, false, 0, given_up, std::move(why)});
  }
}

namespace {

/// `task`: what its host says of it; null: nothing. `fault`: what was found wrong with it; null: nothing.
PoolInstance report_instance(model::TaskId id, const task_host::TaskReport* task, const PoolInstance* fault,
                             const detail::InstanceCalls& calls) {
  PoolInstance one;
  one.task = std::move(id);
  if (task != nullptr) {
    one.pid = task->pid;
    const bool runs = task->state == TaskState::Running && !task->unknown;
    const std::string abandoned = runs ? calls.why_abandoned({one.task, one.pid}) : "";
    one.busy = calls.is_busy({one.task, one.pid});
    one.ready = runs && abandoned.empty();
    if (!abandoned.empty()) {
      one.reason = abandoned + "; it is being ended, and started again";
      return one;
    }
  }
  if (one.ready) {
    return one;
  }
  one.given_up = fault != nullptr && fault->given_up;
  if (fault != nullptr) {
    one.reason = fault->reason;
  } else if (task == nullptr) {
    one.reason = "does not run";
  } else {
    one.reason =
        "is " + std::string(to_string(task->state)) + (task->error.empty() ? "" : ": " + task->error);
  }
  return one;
}

}  // namespace

std::vector<PoolReport> Runtime::Implementation::report_pools(
    const std::vector<task_host::TaskReport>& reports) const {
  std::vector<PoolReport> all;
  if (options.pools.empty()) {
    return all;
  }
  std::map<model::TaskId, const task_host::TaskReport*> tasks;
  for (const auto& report : reports) {
    tasks.insert_or_assign(report.id, &report);
  }
  const Lock lock(mutex);
  for (const auto& pool : options.pools) {
    PoolReport& report = all.emplace_back(PoolReport{pool.name, {}});
    for (int number = 1; number <= pool.size; ++number) {
      const model::TaskId id = model::instance_of(pool, number);
      const auto task = tasks.find(id);
      const auto fault = pool_faults.find(id);
      report.instances.push_back(report_instance(id, task == tasks.end() ? nullptr : task->second,
                                                 fault == pool_faults.end() ? nullptr : &fault->second,
                                                 instance_calls));
    }
  }
  return all;
}

}  // namespace segue::runtime

// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/pool_keeper.hpp>

#include <segue/base/text.hpp>
#include <segue/model/network_sets.hpp>
#include <segue/model/pools.hpp>
#include <segue/runtime/runtime_options.hpp>

#include <unistd.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

namespace segue::runtime::detail {

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

solve::RepairScope scope_of_instance(const DetectedFault& fault) {
  solve::RepairScope scope;
  if (const auto* process = std::get_if<model::DeploymentKey>(&fault.subject)) {
    scope.processes.push_back(*process);
  } else {
    scope.tasks.push_back(instance_of(fault));
  }
  return scope;
}

/// `task`: what its host says of it; null: nothing. `fault`: what was found wrong with it; null: nothing.
PoolInstance report_instance(model::TaskId id, const task_host::TaskReport* task, const PoolInstance* fault,
                             const InstanceCalls& calls) {
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

PoolKeeper::PoolKeeper(const Sources& sources, const RuntimeOptions& options, std::function<void()> notify)
    : sources_(sources),
      options_(options),
      network_(model::pool_network(options.pools)),
      notify_(std::move(notify)),
      calls_(sources.host, network_, notify_),
      allocator_(options.pools, options.pool_budget, calls_),
      repairs_(options.policies.restart, AfterLimit::GoOn),
      removals_(options.policies.restart, AfterLimit::GoOn) {}

Result<type::Value> PoolKeeper::call(const model::TaskId& task, std::string_view operation,
                                     const type::Value& arguments, const Wait& wait) {
  auto answer = calls_.call(task, operation, arguments, wait);
  allocator_.used(task, RealClock::instance().now());
  waits_.ring();
  return answer;
}

void PoolKeeper::take(const model::InstanceQuestion& what, const Wait& wait, model::InstanceAnswer answered) {
  using End = task_host::detail::Watches::End;
  if (!what.lost.task.empty()) notify_();  // so that supervision looks whether it runs
  waits_.add(wait, [this, what, answered = std::move(answered), since = RealClock::instance().now(),
                    is_counted = false](End end) mutable {
    std::optional<Result<model::TakenInstance>> answer;
    if (end == End::Stop) {
      answer = no_longer_wanted();
    } else if (end == End::Closed) {
      answer = fail(ErrorCode::Unavailable, "the runtime ends");
    } else {
      answer = allocator_.take(what, since, RealClock::instance().now());
    }
    if (!answer && end == End::Deadline) {
      answer = fail(ErrorCode::DeadlineExceeded, "no instance of pool " + quote(what.pool) + " is free");
    }
    if (!answer) {
      if (!std::exchange(is_counted, true) && allocator_.begin_waiting(what.pool)) notify_();
      return false;
    }
    if (is_counted) allocator_.end_waiting(what.pool);
    answered(std::move(*answer));
    return true;
  });
}

void PoolKeeper::on_event(const task_host::TaskEvent& event) {
  if (event.state != TaskState::Running) {
    allocator_.lost(event.task, "is " + std::string(to_string(event.state)), RealClock::instance().now());
  }
}

void PoolKeeper::on_event(const task_host::ProcessEvent& event) {
  if (event.gone) {
    allocator_.lost(model::TaskId(event.process.process.str()), "its process is gone",
                    RealClock::instance().now());
  }
}

void PoolKeeper::keep(bool kept) {
  is_kept_ = kept;
  if (!kept) {
    allocator_.reset();
  }
}

std::optional<TimePoint> PoolKeeper::next() const {
  const auto start = repairs_.next();
  const auto end = removals_.next();
  return start && end ? std::min(*start, *end) : start ? start : end;
}

model::Network PoolKeeper::wanted() const {
  model::Network all = network_;
  std::erase_if(all.tasks, [&](const model::Task& task) { return !allocator_.is_wanted(task.id); });
  std::erase_if(all.deployments, [&](const model::Deployment& one) {
    return !allocator_.is_wanted(model::TaskId(one.process.str()));
  });
  return all;
}

model::Network PoolKeeper::part(const model::Network& network) const {
  return is_kept_ && !network_.empty() ? model::subtract(network, model::subtract(network, network_))
                                       : model::Network{};
}

model::Network PoolKeeper::without(const model::Network& network) const {
  if (network_.empty()) {
    return network;
  }
  model::Network rest = model::subtract(network, network_);
  rest.name = network.name;
  return rest;
}

std::optional<Error> PoolKeeper::refusal_for(const model::Network& network) const {
  Diagnostics findings;
  model::detail::check_pools(options_.pools, network, findings);
  return findings.has_errors() ? std::optional(findings.to_error()) : std::nullopt;
}

std::vector<DetectedFault> PoolKeeper::find_faults() {
  const Observation seen = sources_.belief.observe();
  for (const auto& task : part(seen.network).tasks) {
    if (task.state == TaskState::Running) {
      have_run_.insert(task.id);
    }
  }
  auto faults = detail::find_faults(reachable_part(wanted(), sources_.host), seen.network,
                                    model::FailurePolicy::Report);
  for (DetectedFault& fault : faults) {
    if (!have_run_.contains(instance_of(fault))) {
      fault.policy = model::FailurePolicy::Restart;  // whatever shall happen when it fails, it begins
      fault.symptom = "has not been started yet";
    }
  }
  return faults;
}

void PoolKeeper::look_after(const Repair& repair) {
  if (network_.empty() || !is_kept_) {
    return;
  }
  if (begins_again_.exchange(false)) {
    repairs_.reset();
    removals_.reset();
    have_run_.clear();
  }
  end_abandoned(repair);
  start_missing(repair);
  note_instances();
  make_one(repair);
  end_unneeded(repair);
}

void PoolKeeper::note_instances() {
  const TimePoint when = RealClock::instance().now();
  allocator_.note(report(sources_.host.tasks()), when);
  waits_.ring();
}

void PoolKeeper::start_missing(const Repair& repair) {
  const auto faults = find_faults();
  std::vector<DetectedFault> to_start;
  std::ranges::remove_copy_if(faults, std::back_inserter(to_start), is_left_alone);
  const auto decision = repairs_.decide(to_start, RealClock::instance().now());
  for (const auto& fault : decision.given_up) {
    sources_.log.add(EventKind::GivenUp, fault.name(),
                     fault.symptom + ", after " + std::to_string(repairs_.attempts(fault)) +
                         " attempts to start it; further attempts follow at longer intervals");
  }
  for (const auto& fault : decision.repair) {
    start(fault, repair);
  }
  note_faults(decision.repair.empty() ? faults : find_faults());
}

/// Only one at a time, since a request goes before the next one.
void PoolKeeper::make_one(const Repair& repair) {
  std::optional<MemoryOf> known;
  const MemoryOf used = [&](const model::DeploymentKey& process) {
    if (!known) known = memory_of(sources_.host);
    return (*known)(process);
  };
  const auto instance = allocator_.next_to_make(RealClock::instance().now(), used);
  if (!instance) {
    return;
  }
  start({*instance, model::FailurePolicy::Restart, "is made, since calls wait", false}, repair);
  allocator_.add(*instance, RealClock::instance().now());
  note_instances();
  notify_();
}

void PoolKeeper::end_unneeded(const Repair& repair) {
  const TimePoint now = RealClock::instance().now();
  while (const auto instance = allocator_.next_to_leave(now)) {
    sources_.log.add(EventKind::Pool, instance->str(), "is ended, since nobody has needed it");
  }
  std::vector<DetectedFault> unneeded;
  for (const auto& task : network_.tasks) {
    if (!allocator_.is_wanted(task.id)) {
      unneeded.push_back({task.id, model::FailurePolicy::Restart, "is not needed any more"});
    }
  }
  if (!unneeded.empty()) {
    const model::Network seen = part(sources_.belief.observe().network);
    std::erase_if(unneeded,
                  [&](const DetectedFault& fault) { return only(instance_of(fault), seen).empty(); });
  }
  const auto decision = removals_.decide(unneeded, now);
  for (const auto& fault : decision.given_up) {
    sources_.log.add(EventKind::GivenUp, fault.name(),
                     fault.symptom + " and is there still, after " +
                         std::to_string(removals_.attempts(fault)) +
                         " attempts to end it; further attempts follow at longer intervals");
  }
  for (const auto& fault : decision.repair) {
    end(instance_of(fault), repair);
  }
}

void PoolKeeper::end(const model::TaskId& instance, const Repair& repair) {
  int pid = 0;
  for (const auto& report : sources_.host.tasks()) {
    if (report.id == instance) pid = report.pid;
  }
  const InstanceCalls::Life life{instance, pid};
  const bool works_for_nobody = !calls_.why_abandoned(life).empty();
  if (!works_for_nobody && !calls_.retire(life)) {
    return;  // somebody has called it although it was not given to anybody
  }
  Observation seen = sources_.belief.observe();
  for (model::Task& task : seen.network.tasks) {
    // Nobody waits for the operation that it carries out.
    if (task.id == instance && works_for_nobody) task.state = TaskState::Fatal;
  }
  const model::Network there = part(seen.network);
  const model::Network one = only(instance, there);
  solve::RepairScope scope;
  scope.tasks.push_back(instance);
  for (const auto& deployment : one.deployments) {
    scope.processes.push_back(deployment.key());
  }
  if (repair(seen, scope, model::subtract(there, one), works_for_nobody)) {
    calls_.forget(life);
    have_run_.erase(instance);
  }
}

void PoolKeeper::end_abandoned(const Repair& repair) {
  for (const auto& [life, why] : calls_.abandoned()) {
    if (!allocator_.is_wanted(life.instance)) {
      continue;
    }
    start({life.instance, model::FailurePolicy::Restart, why, true}, repair);
    // In the process of the runtime the same one is made anew, since that cannot be ended.
    if (life.pid == ::getpid()) {
      calls_.forget(life);
    }
  }
}

void PoolKeeper::start(const DetectedFault& fault, const Repair& repair) {
  Observation seen = sources_.belief.observe();
  const model::TaskId instance = instance_of(fault);
  for (model::Task& task : seen.network.tasks) {
    if (task.id == instance && fault.needs_process) {
      task.state = TaskState::Fatal;  // whatever it says: its process is to be replaced
    }
  }
  sources_.log.add(allocator_.is_wanted(instance) ? EventKind::Repair : EventKind::Pool, instance.str(),
                   fault.name() + " " + fault.symptom);
  if (have_run_.contains(instance)) {
    sources_.journal.drifted(fault.name(), fault.name() + " " + fault.symptom, "repaired");
  }
  calls_.starts(instance);
  allocator_.lost(instance, "is being started", RealClock::instance().now());
  // A call that an instance carries out cannot be interrupted, so a process that is to be replaced is killed.
  const auto pools_part = model::unite(only(instance, network_), part(seen.network));
  if (repair(seen, scope_of_instance(fault), pools_part, fault.needs_process)) {
    have_run_.insert(instance);  // also where it has failed before it is looked at again
  }
}

std::string PoolKeeper::reason_of(const DetectedFault& fault) const {
  std::string why = fault.symptom;
  if (const auto* process = std::get_if<model::DeploymentKey>(&fault.subject)) {
    const auto ended = sources_.faults.ended();
    const auto found = ended.find(*process);
    why.insert(0, "its process ");
    if (found != ended.end()) why.append(" (").append(found->second).append(")");
  }
  if (is_left_alone(fault)) {
    return why + ", and is left so, as its 'on_failure' says";
  }
  const int attempts = repairs_.attempts(fault);
  return attempts == 0 ? why
                       : why + "; " + counted(static_cast<std::size_t>(attempts), "attempt") +
                             " to start it have not helped";
}

void PoolKeeper::note_faults(const std::vector<DetectedFault>& faults) {
  std::map<model::TaskId, PoolInstance> noted;
  for (const auto& fault : faults) {
    const bool given_up = is_left_alone(fault) || repairs_.attempts(fault) >= options_.policies.restart.max;
    const model::TaskId instance = instance_of(fault);
    noted.insert_or_assign(instance, PoolInstance{instance, false, 0, given_up, reason_of(fault)});
  }
  const Lock lock(mutex_);
  faults_ = std::move(noted);
}

std::vector<PoolReport> PoolKeeper::report(const std::vector<task_host::TaskReport>& reports) const {
  std::vector<PoolReport> all;
  if (options_.pools.empty()) {
    return all;
  }
  std::map<model::TaskId, const task_host::TaskReport*> tasks;
  for (const auto& report : reports) {
    tasks.insert_or_assign(report.id, &report);
  }
  all = allocator_.pools();
  const Lock lock(mutex_);
  for (PoolReport& pool : all) {
    for (PoolInstance& instance : pool.instances) {
      const auto task = tasks.find(instance.task);
      const auto fault = faults_.find(instance.task);
      instance = report_instance(instance.task, task == tasks.end() ? nullptr : task->second,
                                 fault == faults_.end() ? nullptr : &fault->second, calls_);
    }
  }
  return all;
}

}  // namespace segue::runtime::detail

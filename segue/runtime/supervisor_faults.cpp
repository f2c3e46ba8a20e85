// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/runtime/fault_owners.hpp>
#include <segue/runtime/robot_snapshot.hpp>
#include <segue/runtime/supervisor.hpp>

#include <algorithm>
#include <chrono>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <variant>

/// Troubles of the robot, how Supervisor handles them, and its report to whoever looks.
namespace segue::runtime::detail {

namespace {

std::string names_of(const std::vector<DetectedFault>& faults) {
  std::vector<std::string> names;
  for (const auto& fault : faults) {
    names.push_back(fault.name() + " " + fault.symptom);
  }
  return listed(names);
}

/// Left so by its policy. A task that has stopped may have done so on purpose; one that is broken, or without
/// its process, has not.
bool is_left_broken(const DetectedFault& fault, const model::TaskIndex& observed) {
  if (fault.policy != model::FailurePolicy::Report) return false;
  const auto* task = std::get_if<model::TaskId>(&fault.subject);
  const model::Task* seen = task == nullptr ? nullptr : observed.find(*task);
  return task == nullptr ||
         (seen != nullptr && (seen->state == TaskState::Exception || seen->state == TaskState::Fatal));
}

std::vector<DetectedFault> without(std::vector<DetectedFault> faults,
                                   const std::vector<DetectedFault>& others) {
  std::set<std::string> names;
  for (const auto& other : others) {
    names.insert(other.name());
  }
  std::erase_if(faults, [&](const DetectedFault& fault) { return names.contains(fault.name()); });
  return faults;
}

}  // namespace

std::vector<DetectedFault> Supervisor::faults_in(const model::Network& observed) const {
  const auto held = parts_.belief.held();
  if (held.wanted) {
    return find_faults(reachable_part(*held.wanted, parts_.host), observed,
                       parts_.options.policies.on_failure);
  }
  std::vector<DetectedFault> faults;
  for (const auto& task : parts_.pools.without(observed).tasks) {
    if (task.state == TaskState::Exception || task.state == TaskState::Fatal) {
      faults.push_back({task.id, model::FailurePolicy::Report, "is " + std::string(to_string(task.state))});
    }
  }
  return faults;
}

std::vector<UnresolvedFault> Supervisor::handle_faults(const Observation& seen) {
  if (!parts_.belief.held().wanted) {
    return {};
  }
  const auto faults = faults_in(seen.network);
  const auto decision = repairs_.decide(faults, RealClock::instance().now());
  parts_.faults.set_handled(repairs_.handling(faults));
  report_given_up(decision.given_up);
  note_in_repair(faults);
  if (decision.fallback) {
    fall_back(seen);
  } else if (!decision.repair.empty()) {
    repair_now(decision.repair, seen);
    note_in_repair(without(faults, decision.repair));
  }
  return faults.empty() ? std::vector<UnresolvedFault>() : left_of(faults, seen);
}

void Supervisor::repair_now(const std::vector<DetectedFault>& faults, const Observation& seen) {
  parts_.log.add(EventKind::Repair, parts_.belief.controller().name.str(), names_of(faults));
  for (const auto& fault : faults) {
    parts_.journal.drifted(fault.name(), fault.name() + " " + fault.symptom, "repaired");
  }
  repair(Cause::Repair, seen, scope_of(faults), parts_.pools.part(seen.network));
}

std::vector<UnresolvedFault> Supervisor::left_of(const std::vector<DetectedFault>& faults,
                                                 const Observation& seen) const {
  const model::Network desired = parts_.belief.held().desired();
  const model::TaskIndex observed(seen.network);
  const FaultOwners owners(desired, parts_.controllers);
  std::vector<UnresolvedFault> left;
  for (const auto& fault : repairs_.exhausted(faults)) {
    left.push_back(owners.unresolved(fault, sentence_of(fault, repairs_)));
  }
  for (const auto& fault : faults) {
    if (is_left_broken(fault, observed)) {
      left.push_back(owners.unresolved(
          fault, fault.name() + " " + fault.symptom + ", and is left so, as its 'on_failure' says"));
    }
  }
  return left;
}

/// Of these, those of which the policies permit further attempts are being mended.
void Supervisor::note_in_repair(const std::vector<DetectedFault>& faults) {
  std::vector<DetectedFault> repaired = without(faults, repairs_.exhausted(faults));
  std::erase_if(repaired, [](const DetectedFault& fault) {
    return fault.policy != model::FailurePolicy::Restart && fault.policy != model::FailurePolicy::Recover;
  });
  const model::Network desired = repaired.empty() ? model::Network() : parts_.belief.held().desired();
  const FaultOwners owners(desired, parts_.controllers);
  std::vector<UnresolvedFault> mended;
  for (const auto& fault : repaired) {
    mended.push_back(owners.unresolved(fault, fault.name() + " " + fault.symptom));
  }
  parts_.faults.set_in_repair(std::move(mended));
}

void Supervisor::report_given_up(const std::vector<DetectedFault>& faults) {
  for (const auto& fault : faults) {
    const int attempts = repairs_.attempts(fault);
    parts_.journal.drifted(fault.name(), fault.name() + " " + fault.symptom, "given up");
    parts_.log.add(
        EventKind::GivenUp, fault.name(),
        fault.symptom +
            (attempts == 0 ? ", and only a new process would help, which its policy 'recover' excludes"
                           : " still, after " + std::to_string(attempts) + " attempts") +
            "; the next request tries again");
  }
}

RobotSnapshot Supervisor::judge(task_host::TaskHost::View seen) {
  RobotSnapshot snapshot{std::move(seen), parts_.host.computers(), {}, {}, {}};
  snapshot.pools = parts_.pools.report(snapshot.seen.tasks);
  const auto faults = faults_in(snapshot.seen.network);
  const auto handled = parts_.faults.handled();
  const auto ended = parts_.faults.ended();
  const auto loss = parts_.host.loss();
  const RuntimeState state = parts_.queue.state();
  snapshot.health =
      health_of({.in_transition = parts_.queue.is_active(),
                 .lost = loss ? std::optional(to_string(*loss)) : std::nullopt,
                 .last_failure = state == RuntimeState::Failed ? std::optional(parts_.history.last_error())
                                                               : std::nullopt,
                 .fallback = parts_.controllers.fallback_name(),
                 .faults = faults,
                 .handled = handled,
                 .ended = ended,
                 .tasks = snapshot.seen.tasks,
                 .computers = snapshot.computers,
                 .pools = snapshot.pools});
  parts_.trouble_times.note(snapshot.health.troubles, std::chrono::system_clock::now());
  return snapshot;
}

RobotSnapshot Supervisor::snapshot() {
  RobotSnapshot snapshot = judge(parts_.host.snapshot());
  if (snapshot.health.state != Health::State::InTransition) {
    snapshot.differences = switching_.differences_from(snapshot.seen.network, &snapshot.seen.connections);
  }
  return snapshot;
}

}  // namespace segue::runtime::detail

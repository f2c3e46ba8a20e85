// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/model/controller_names.hpp>
#include <segue/runtime/runtime_implementation.hpp>

#include <algorithm>
#include <iterator>
#include <utility>

namespace segue::runtime {

using detail::DetectedFault;
using detail::Observation;

namespace {

std::string names_of(const std::vector<DetectedFault>& faults) {
  std::vector<std::string> names;
  for (const auto& fault : faults) {
    names.push_back(fault.name() + " " + fault.symptom);
  }
  return listed(names);
}

/// The running controllers that have the part; all where it is in none of them, such as a gateway.
std::vector<model::NetworkName> controllers_with(const DetectedFault& fault, const model::Network& running,
                                                 const Controllers& known) {
  std::vector<model::TaskId> tasks;
  if (const auto* task = std::get_if<model::TaskId>(&fault.subject)) {
    tasks.push_back(*task);
  } else {
    for (const auto& [placed, process] : model::task_processes(running)) {
      if (process == std::get<model::DeploymentKey>(fault.subject)) {
        tasks.push_back(placed);
      }
    }
  }
  const auto names = model::controllers_in(running.name.str());
  std::vector<model::NetworkName> with;
  std::ranges::copy_if(names, std::back_inserter(with), [&](const model::NetworkName& name) {
    const auto found = known.find(name);
    return found != known.end() && std::ranges::any_of(tasks, [&](const model::TaskId& task) {
             return found->second.find_task(task) != nullptr;
           });
  });
  return with.empty() ? names : with;
}

/// Left so by its policy. A task that has stopped may have done so on purpose; one that is broken, or without
/// its process, has not.
bool is_left_broken(const DetectedFault& fault, const model::Network& observed) {
  if (fault.policy != model::FailurePolicy::Report) return false;
  const auto* task = std::get_if<model::TaskId>(&fault.subject);
  const model::Task* seen = task == nullptr ? nullptr : observed.find_task(*task);
  return task == nullptr ||
         (seen != nullptr && (seen->state == TaskState::Exception || seen->state == TaskState::Fatal));
}

/// `running`, `known`: as of controllers_with().
UnresolvedFault as_unresolved(const DetectedFault& fault, std::string sentence, const model::Network& running,
                              const Controllers& known) {
  const auto* task = std::get_if<model::TaskId>(&fault.subject);
  return {std::move(sentence), controllers_with(fault, running, known),
          task == nullptr ? std::nullopt : std::optional(*task)};
}

std::vector<DetectedFault> without(std::vector<DetectedFault> faults,
                                   const std::vector<DetectedFault>& others) {
  std::erase_if(faults, [&](const DetectedFault& fault) {
    return std::ranges::any_of(others,
                               [&](const DetectedFault& other) { return other.name() == fault.name(); });
  });
  return faults;
}

}  // namespace

std::vector<UnresolvedFault> Runtime::Implementation::handle_faults(const Observation& seen) {
  const auto held = belief.held();
  if (!held.wanted) {
    return {};
  }
  const auto faults = faults_in(seen.network);
  const auto decision = repairs.decide(faults, RealClock::instance().now());
  {
    const std::lock_guard lock(mutex);
    handled = repairs.handling(faults);
  }
  report_given_up(decision.given_up);
  note_in_repair(faults);
  if (decision.fallback) {
    fall_back(seen);
  } else if (!decision.repair.empty()) {
    log.add(EventKind::Repair, held.controller.name.str(), names_of(decision.repair));
    for (const auto& fault : decision.repair) {
      journal.drifted(fault.name(), fault.name() + " " + fault.symptom, "repaired");
    }
    repair(Cause::Repair, seen, scope_of(decision.repair), pool_part(seen.network));
    note_in_repair(without(faults, decision.repair));
  }
  const model::Network desired = belief.held().desired();
  std::vector<UnresolvedFault> left;
  const std::lock_guard lock(mutex);
  const auto add = [&](const DetectedFault& fault, std::string sentence) {
    left.push_back(as_unresolved(fault, std::move(sentence), desired, definitions.controllers));
  };
  for (const auto& fault : repairs.exhausted(faults)) {
    add(fault, sentence_of(fault, repairs));
  }
  for (const auto& fault : faults) {
    if (is_left_broken(fault, seen.network)) {
      add(fault, fault.name() + " " + fault.symptom + ", and is left so, as its 'on_failure' says");
    }
  }
  return left;
}

/// Of these, those of which the policies permit further attempts are being mended.
void Runtime::Implementation::note_in_repair(const std::vector<DetectedFault>& faults) {
  const model::Network desired = belief.held().desired();
  std::vector<UnresolvedFault> mended;
  const std::lock_guard lock(mutex);
  for (const auto& fault : without(faults, repairs.exhausted(faults))) {
    const bool is_mended =
        fault.policy == model::FailurePolicy::Restart || fault.policy == model::FailurePolicy::Recover;
    if (is_mended) {
      mended.push_back(
          as_unresolved(fault, fault.name() + " " + fault.symptom, desired, definitions.controllers));
    }
  }
  in_repair = std::move(mended);
}

void Runtime::Implementation::report_given_up(const std::vector<DetectedFault>& faults) {
  for (const auto& fault : faults) {
    const int attempts = repairs.attempts(fault);
    journal.drifted(fault.name(), fault.name() + " " + fault.symptom, "given up");
    log.add(EventKind::GivenUp, fault.name(),
            fault.symptom +
                (attempts == 0 ? ", and only a new process would help, which its policy 'recover' excludes"
                               : " still, after " + std::to_string(attempts) + " attempts") +
                "; the next request tries again");
  }
}

}  // namespace segue::runtime

// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/model/controller_names.hpp>
#include <segue/runtime/runtime_implementation.hpp>

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <string>
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

/// Which of the running controllers have which part.
class Owners {
 public:
  /// Both outlive this.
  Owners(const model::Network& running, const Controllers& known)
      : running_(running), names_(model::controllers_in(running.name.str())) {
    for (const auto& name : names_) {
      const auto found = known.find(name);
      if (found != known.end()) tasks_.emplace(name, model::TaskIndex(found->second));
    }
  }

  /// All where it is in none of them, such as a gateway.
  [[nodiscard]] std::vector<model::NetworkName> of(const DetectedFault& fault) const {
    const auto tasks = tasks_of(fault);
    std::vector<model::NetworkName> with;
    std::ranges::copy_if(names_, std::back_inserter(with), [&](const model::NetworkName& name) {
      const auto found = tasks_.find(name);
      return found != tasks_.end() && std::ranges::any_of(tasks, [&](const model::TaskId& task) {
               return found->second.find(task) != nullptr;
             });
    });
    return with.empty() ? names_ : with;
  }

 private:
  [[nodiscard]] std::vector<model::TaskId> tasks_of(const DetectedFault& fault) const {
    if (const auto* task = std::get_if<model::TaskId>(&fault.subject)) return {*task};
    std::vector<model::TaskId> tasks;
    for (const auto& [placed, process] : model::task_processes(running_)) {
      if (process == std::get<model::DeploymentKey>(fault.subject)) tasks.push_back(placed);
    }
    return tasks;
  }

  const model::Network& running_;
  const std::vector<model::NetworkName> names_;
  std::map<model::NetworkName, model::TaskIndex> tasks_;
};

/// Left so by its policy. A task that has stopped may have done so on purpose; one that is broken, or without
/// its process, has not.
bool is_left_broken(const DetectedFault& fault, const model::TaskIndex& observed) {
  if (fault.policy != model::FailurePolicy::Report) return false;
  const auto* task = std::get_if<model::TaskId>(&fault.subject);
  const model::Task* seen = task == nullptr ? nullptr : observed.find(*task);
  return task == nullptr ||
         (seen != nullptr && (seen->state == TaskState::Exception || seen->state == TaskState::Fatal));
}

UnresolvedFault as_unresolved(const DetectedFault& fault, std::string sentence, const Owners& owners) {
  const auto* task = std::get_if<model::TaskId>(&fault.subject);
  return {std::move(sentence), owners.of(fault), task == nullptr ? std::nullopt : std::optional(*task)};
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

std::vector<UnresolvedFault> Runtime::Implementation::handle_faults(const Observation& seen) {
  const auto held = belief.held();
  if (!held.wanted) {
    return {};
  }
  const auto faults = faults_in(seen.network);
  const auto decision = repairs.decide(faults, RealClock::instance().now());
  {
    const Lock lock(mutex);
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
  if (faults.empty()) {
    return {};
  }
  const model::Network desired = belief.held().desired();
  const model::TaskIndex observed(seen.network);
  std::vector<UnresolvedFault> left;
  const Lock lock(mutex);
  const Owners owners(desired, definitions.controllers);
  const auto add = [&](const DetectedFault& fault, std::string sentence) {
    left.push_back(as_unresolved(fault, std::move(sentence), owners));
  };
  for (const auto& fault : repairs.exhausted(faults)) {
    add(fault, sentence_of(fault, repairs));
  }
  for (const auto& fault : faults) {
    if (is_left_broken(fault, observed)) {
      add(fault, fault.name() + " " + fault.symptom + ", and is left so, as its 'on_failure' says");
    }
  }
  return left;
}

/// Of these, those of which the policies permit further attempts are being mended.
void Runtime::Implementation::note_in_repair(const std::vector<DetectedFault>& faults) {
  std::vector<DetectedFault> repaired = without(faults, repairs.exhausted(faults));
  std::erase_if(repaired, [](const DetectedFault& fault) {
    return fault.policy != model::FailurePolicy::Restart && fault.policy != model::FailurePolicy::Recover;
  });
  std::vector<UnresolvedFault> mended;
  const model::Network desired = repaired.empty() ? model::Network() : belief.held().desired();
  const Lock lock(mutex);
  const Owners owners(desired, definitions.controllers);
  for (const auto& fault : repaired) {
    mended.push_back(as_unresolved(fault, fault.name() + " " + fault.symptom, owners));
  }
  const bool has_any = !in_repair.empty() || !mended.empty();
  in_repair = std::move(mended);
  if (has_any) {
    changes.add();
  }
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

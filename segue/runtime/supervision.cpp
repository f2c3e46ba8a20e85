// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/supervision.hpp>

#include <segue/base/text.hpp>
#include <segue/model/network_sets.hpp>

#include <algorithm>
#include <set>

namespace segue::runtime::detail {

namespace {

using model::FailurePolicy;

/// A subject without a fault for this long, and for twice its back-off, starts again at its first attempt.
constexpr Duration kRecoveredAfter = std::chrono::seconds(10);
constexpr Duration kLongestBackoff = std::chrono::minutes(5);

class FaultFinder {
 public:
  FaultFinder(const model::Network& wanted, const model::Network& observed, FailurePolicy otherwise)
      : wanted_(wanted), observed_(observed), otherwise_(otherwise), wanted_tasks_(wanted), tasks_(observed) {
    for (const auto& deployment : wanted.deployments) {
      for (const auto& placement : deployment.tasks) {
        deployment_of_.emplace(placement.task, &deployment);
      }
    }
    for (const auto& deployment : observed.deployments) {
      processes_.emplace(deployment.key(), &deployment);
    }
  }

  std::vector<DetectedFault> take() {
    for (const auto& deployment : wanted_.deployments) {
      check(deployment);
    }
    for (const auto& task : wanted_.tasks) {
      check(task);
    }
    check_connections();
    return std::move(found_);
  }

 private:
  void check(const model::Deployment& deployment) {
    const auto found = processes_.find(deployment.key());
    if (found != processes_.end() && found->second->same_process(deployment)) {
      return;
    }
    const bool gone = found == processes_.end();
    found_.push_back({deployment.key(), policy_of(deployment), gone ? "is gone" : "does not answer", true});
    for (const auto& placement : deployment.tasks) {
      covered_.insert(placement.task);
    }
  }

  /// The strongest of the policies of the process and of its tasks, which fail with it.
  [[nodiscard]] FailurePolicy policy_of(const model::Deployment& deployment) const {
    FailurePolicy strongest = deployment.on_failure.value_or(otherwise_);
    for (const auto& placement : deployment.tasks) {
      const model::Task* task = wanted_tasks_.find(placement.task);
      if (task != nullptr && task->on_failure) {
        strongest = std::max(strongest, *task->on_failure);
      }
    }
    return strongest;
  }

  void check(const model::Task& task) {
    if (covered_.contains(task.id)) {
      return;
    }
    const model::Task* found = tasks_.find(task.id);
    if (found == nullptr) {
      add(task, "is gone", false);
    } else if (found->state != task.state) {
      add(task, "is " + std::string(to_string(found->state)), found->state == TaskState::Fatal);
    }
  }

  /// A missing connection counts as a fault of its reader, unless one of its two tasks has a fault already.
  void check_connections() {
    const auto there = model::connection_texts(observed_);
    for (const auto& connection : wanted_.connections) {
      const bool known = covered_.contains(connection.from.task) || covered_.contains(connection.to.task);
      if (known || there.contains(to_string(connection))) {
        continue;
      }
      if (const model::Task* reader = wanted_tasks_.find(connection.to.task)) {
        add(*reader, "has lost " + to_string(connection), false);
        found_.back().lacks_connection = true;
      }
    }
  }

  void add(const model::Task& task, std::string symptom, bool needs_process) {
    const auto deployment = deployment_of_.find(task.id);
    const auto of_process =
        deployment == deployment_of_.end() ? std::nullopt : deployment->second->on_failure;
    const FailurePolicy policy = task.on_failure.value_or(of_process.value_or(otherwise_));
    found_.push_back({task.id, policy, std::move(symptom), needs_process});
    covered_.insert(task.id);
  }

  const model::Network& wanted_;
  const model::Network& observed_;
  const FailurePolicy otherwise_;
  std::map<model::TaskId, const model::Deployment*> deployment_of_;
  const model::TaskIndex wanted_tasks_;
  const model::TaskIndex tasks_;  ///< that are observed
  std::map<model::DeploymentKey, const model::Deployment*> processes_;
  std::set<model::TaskId> covered_;
  std::vector<DetectedFault> found_;
};

}  // namespace

std::string DetectedFault::name() const {
  if (const auto* task = std::get_if<model::TaskId>(&subject)) {
    return "task " + quote(task->str());
  }
  return "process " + quote(to_string(std::get<model::DeploymentKey>(subject)));
}

std::vector<DetectedFault> find_faults(const model::Network& wanted, const model::Network& observed,
                                       model::FailurePolicy otherwise) {
  return FaultFinder(wanted, observed, otherwise).take();
}

Duration RepairScheduler::backoff(int attempts) const {
  Duration wait = restart_.backoff;
  for (int i = 0; i < attempts && wait < kLongestBackoff; ++i) {
    wait *= 2;
  }
  return std::min(wait, kLongestBackoff);
}

void RepairScheduler::forget_recovered(TimePoint now) {
  std::erase_if(cases_, [&](const auto& entry) {
    const Case& one = entry.second;
    return now - one.last_seen > std::max(kRecoveredAfter, backoff(one.attempts) * 2);
  });
}

void RepairScheduler::consider(const DetectedFault& fault, TimePoint now, Decision& decision) {
  const auto [entry, is_new] = cases_.try_emplace(fault.name());
  Case& one = entry->second;
  one.last_seen = now;
  if (is_new) {
    one.next = now + backoff(0);
  }
  const bool hopeless = fault.policy == FailurePolicy::Recover && fault.needs_process;
  if (!one.given_up && (hopeless || one.attempts >= restart_.max)) {
    one.given_up = true;
    decision.given_up.push_back(fault);
  }
  if (now >= one.next && may_try(one)) {
    ++one.attempts;
    one.next = now + backoff(one.attempts);
    decision.repair.push_back(fault);
  }
}

RepairScheduler::Decision RepairScheduler::decide(const std::vector<DetectedFault>& faults, TimePoint now) {
  Decision decision;
  decided_ = now;
  forget_recovered(now);
  for (const auto& fault : faults) {
    if (fault.policy == FailurePolicy::Fallback) {
      decision.fallback = true;
    } else if (fault.policy != FailurePolicy::Report) {
      consider(fault, now, decision);
    }
  }
  return decision;
}

std::optional<TimePoint> RepairScheduler::next() const {
  std::optional<TimePoint> first;
  for (const auto& [name, one] : cases_) {
    if (one.last_seen == decided_ && may_try(one) && (!first || one.next < *first)) {
      first = one.next;
    }
  }
  return first;
}

std::vector<DetectedFault> RepairScheduler::exhausted(const std::vector<DetectedFault>& faults) const {
  std::vector<DetectedFault> list;
  for (const auto& fault : faults) {
    const auto found = cases_.find(fault.name());
    if (found != cases_.end() && found->second.given_up) {
      list.push_back(fault);
    }
  }
  return list;
}

std::map<std::string, Handling> RepairScheduler::handling(const std::vector<DetectedFault>& faults) const {
  std::map<std::string, Handling> all;
  for (const auto& fault : faults) {
    const auto found = cases_.find(fault.name());
    if (found != cases_.end()) {
      all.insert_or_assign(fault.name(), Handling{found->second.attempts, found->second.given_up});
    }
  }
  return all;
}

int RepairScheduler::attempts(const DetectedFault& fault) const {
  const auto found = cases_.find(fault.name());
  return found == cases_.end() ? 0 : found->second.attempts;
}

solve::RepairScope scope_of(const std::vector<DetectedFault>& faults) {
  solve::RepairScope scope;
  for (const auto& fault : faults) {
    if (const auto* task = std::get_if<model::TaskId>(&fault.subject)) {
      scope.tasks.push_back(*task);
    } else {
      scope.processes.push_back(std::get<model::DeploymentKey>(fault.subject));
    }
  }
  return scope;
}

std::string sentence_of(const DetectedFault& fault, const detail::RepairScheduler& scheduler) {
  return fault.name() + " " + fault.symptom + "; " + std::to_string(scheduler.attempts(fault)) +
         " attempts have not helped";
}

}  // namespace segue::runtime::detail

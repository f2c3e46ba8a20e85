// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/look_ahead_savings.hpp>

#include <segue/model/network_sets.hpp>
#include <segue/runtime/leftovers.hpp>
#include <segue/solve/estimate.hpp>

#include <algorithm>
#include <cstddef>
#include <set>
#include <utility>
#include <vector>

namespace segue::runtime::detail {

namespace {

/// Beyond that many actions, all are learned anew.
constexpr std::size_t kMostActions = 20'000;

std::set<model::TaskId> prepared_tasks(const BeforeTransition& before, const model::Network& wanted) {
  std::set<model::TaskId> ids;
  for (const auto& task : before.standby.tasks) {
    if (wanted.find_task(task.id) != nullptr && before.current.find_task(task.id) != nullptr) {
      ids.insert(task.id);
    }
  }
  return ids;
}

/// Those that were configured already and did not have to be configured anew.
std::size_t count_ready(const BeforeTransition& before, const SwitchResult& result,
                        std::set<model::TaskId> ids) {
  for (const auto& record : result.actions) {
    if (record.action.kind == model::ActionKind::Configure && record.action.task() != nullptr) {
      ids.erase(*record.action.task());
    }
  }
  return static_cast<std::size_t>(std::ranges::count_if(
      ids, [&](const auto& id) { return is_configured(before.current.find_task(id)->state); }));
}

}  // namespace

model::Network without_prepared(const BeforeTransition& before, const model::Network& wanted) {
  const auto ids = prepared_tasks(before, wanted);
  model::Network rest = before.current;
  std::erase_if(rest.tasks, [&](const model::Task& task) { return ids.contains(task.id); });
  std::erase_if(rest.connections, [&](const model::Connection& connection) {
    return ids.contains(connection.from.task) || ids.contains(connection.to.task);
  });
  std::erase_if(rest.deployments, [&](model::Deployment& deployment) {
    const auto taken = std::erase_if(
        deployment.tasks, [&](const model::Placement& placement) { return ids.contains(placement.task); });
    const bool ran = std::ranges::any_of(before.controller.deployments,
                                         [&](const auto& other) { return other.key() == deployment.key(); });
    return taken > 0 && deployment.tasks.empty() && !ran;
  });
  return rest;
}

void LookAheadSavings::learn(const SwitchResult& result) {
  if (measured_.size() > kMostActions) {
    measured_.clear();
  }
  for (const auto& record : result.actions) {
    if (record.executed && !record.error) {
      measured_.insert_or_assign(record.action.label(), record.took.value_or(record.duration));
    }
  }
}

std::optional<journal::PreparedAhead> LookAheadSavings::of(const SwitchResult& result,
                                                           const BeforeTransition& before,
                                                           const SwitchPlan& plan,
                                                           const task_host::TaskHost& host,
                                                           const model::ComponentCatalog& catalog,
                                                           const model::ActionTimes& known) const {
  const std::size_t ready = count_ready(before, result, prepared_tasks(before, plan.controller));
  if (ready == 0) {
    return std::nullopt;
  }
  const auto unprepared = without_prepared(before, plan.controller);
  auto how = solve_options(host, result.order, false);
  how.idle = idle_tasks(unprepared, before.controller);
  const auto transition = solve_from_observed(unprepared, plan.target, catalog, std::move(how));
  if (!transition) {
    return std::nullopt;
  }
  std::vector<std::optional<Duration>> durations;
  for (const auto& action : transition->actions) {
    const auto found = measured_.find(action.label());
    durations.push_back(found == measured_.end() ? std::nullopt : std::optional(found->second));
  }
  return journal::PreparedAhead{
      ready, solve::typical_duration(unprepared, *transition, model::Phase::Prepare, known, durations)};
}

}  // namespace segue::runtime::detail

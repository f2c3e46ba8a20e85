// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/look_ahead.hpp>

#include <segue/runtime/beside.hpp>
#include <segue/solve/look_ahead.hpp>

#include <algorithm>
#include <map>
#include <set>

namespace segue::runtime::detail {

namespace {

struct Cost {
  std::size_t processes = 0;
  std::uint64_t memory = 0;
};

Cost cost_of(const model::Network& beside, const model::Network& controller, const MemoryOf& memory_of) {
  std::set<model::DeploymentKey> running;
  for (const auto& deployment : controller.deployments) {
    running.insert(deployment.key());
  }
  Cost cost;
  for (const auto& deployment : beside.deployments) {
    if (!running.contains(deployment.key())) {
      ++cost.processes;
      cost.memory += memory_of(deployment.key());
    }
  }
  return cost;
}

/// How much of a controller is there, or will be.
Readiness readiness_of(const model::Network& wanted, const model::Network& there) {
  Readiness readiness{wanted.name, true, 0, wanted.tasks.size(), {}};
  std::set<model::TaskId> ids;
  for (const auto& task : there.tasks) {
    if (is_configured(task.state)) {
      ids.insert(task.id);
    }
  }
  for (const auto& task : wanted.tasks) {
    readiness.prepared += ids.contains(task.id) ? 1 : 0;
  }
  return readiness;
}

std::map<model::TaskId, model::DeploymentKey> seats_of(const model::Network& network) {
  std::map<model::TaskId, model::DeploymentKey> seats;
  for (const auto& deployment : network.deployments) {
    for (const auto& seat : deployment.tasks) {
      seats.emplace(seat.task, deployment.key());
    }
  }
  return seats;
}

}  // namespace

LookAheadPlan look_ahead(const model::Network& controller, const std::vector<Wish>& wishes,
                         const model::ComponentCatalog& catalog, const model::LookAhead& budget,
                         const MemoryOf& memory_of) {
  LookAheadPlan plan;
  model::Network all = controller;
  for (const auto& wish : wishes) {
    if (!wish.network) {
      plan.readiness.push_back({wish.name, false, 0, 0, "no such controller"});
      continue;
    }
    model::Network more = solve::warmed(all, *wish.network, catalog);
    model::Network beside = without(more, controller);
    const Cost cost = cost_of(beside, controller, memory_of);
    const bool fits = cost.processes <= static_cast<std::size_t>(std::max(budget.processes, 0)) &&
                      cost.memory <= budget.memory;
    if (fits) {
      all = std::move(more);
      plan.beside = std::move(beside);
    }
    Readiness readiness = readiness_of(*wish.network, all);
    readiness.ready = fits;
    if (!fits) {
      readiness.reason = "beyond the budget of " + std::to_string(budget.processes) + " processes and " +
                         std::to_string(budget.memory / 1'000'000) + " MB for look-ahead";
    }
    plan.readiness.push_back(std::move(readiness));
  }
  return plan;
}

model::Network already_there(const model::Network& beside, const model::Network& current) {
  model::Network kept;
  const auto seats = seats_of(beside);
  const auto places = seats_of(current);
  std::set<model::TaskId> ids;
  for (const auto& task : beside.tasks) {
    const model::Task* now = current.find_task(task.id);
    const auto seat = seats.find(task.id);
    const auto place = places.find(task.id);
    const bool same_place = (seat == seats.end()) == (place == places.end()) &&
                            (seat == seats.end() || seat->second == place->second);
    const bool stays = now != nullptr && now->component == task.component && same_place &&
                       now->same_configuration(task) && is_configured(now->state) && !is_error(now->state);
    if (stays) {
      kept.tasks.push_back(task);
      ids.insert(task.id);
    }
  }
  for (model::Deployment deployment : beside.deployments) {
    std::erase_if(deployment.tasks, [&](const model::Placement& seat) { return !ids.contains(seat.task); });
    const bool there = std::any_of(current.deployments.begin(), current.deployments.end(),
                                   [&](const model::Deployment& other) {
                                     return other.key() == deployment.key() && other.same_process(deployment);
                                   });
    if (there) {
      kept.deployments.push_back(std::move(deployment));
    }
  }
  for (const auto& connection : beside.connections) {
    const bool there = std::find(current.connections.begin(), current.connections.end(), connection) !=
                       current.connections.end();
    if (there && ids.contains(connection.from.task) && ids.contains(connection.to.task)) {
      kept.connections.push_back(connection);
    }
  }
  return kept;
}

}  // namespace segue::runtime::detail

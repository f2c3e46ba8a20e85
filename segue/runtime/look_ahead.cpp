// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/look_ahead.hpp>
#include <segue/runtime/network_parts.hpp>

#include <segue/model/network_sets.hpp>
#include <segue/solve/standby_network.hpp>

#include <algorithm>
#include <set>

namespace segue::runtime::detail {

namespace {

struct Cost {
  std::size_t processes = 0;
  std::uint64_t memory = 0;
};

using Keys = std::set<model::DeploymentKey>;

Keys processes_of(const model::Network& network) {
  Keys keys;
  for (const auto& deployment : network.deployments) {
    keys.insert(deployment.key());
  }
  return keys;
}

/// Limits the number of standby processes and their memory.
class Budget {
 public:
  Budget(const model::LookAhead& limit, const MemoryOf& memory_of) : limit_(limit), memory_of_(memory_of) {}

  /// Reserves a process. Returns false and reserves nothing if it exceeds the budget.
  bool take(const model::DeploymentKey& process) {
    const std::uint64_t memory = memory_of_(process);
    if (taken_.processes >= static_cast<std::size_t>(std::max(limit_.processes, 0)) ||
        memory > limit_.memory - taken_.memory) {
      return false;
    }
    ++taken_.processes;
    taken_.memory += memory;
    return true;
  }
  [[nodiscard]] std::string text() const {
    return "the budget of " + std::to_string(limit_.processes) + " processes and " +
           std::to_string(limit_.memory / 1'000'000) + " MB for look-ahead";
  }

 private:
  const model::LookAhead& limit_;
  const MemoryOf& memory_of_;
  Cost taken_;
};

/// Counts the tasks of `wanted` that are configured in `there`.
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

}  // namespace

LookAheadPlan look_ahead(const model::Network& controller,
                         const std::vector<PrepareRequest>& requests_to_prepare,
                         const model::ComponentCatalog& catalog, const model::LookAhead& budget,
                         const MemoryOf& memory_of) {
  LookAheadPlan plan;
  model::Network all = controller;
  Keys there = processes_of(controller);
  Budget left(budget, memory_of);
  for (const auto& request : requests_to_prepare) {
    if (!request.network) {
      plan.readiness.push_back({request.name, false, 0, 0, "no such controller"});
      continue;
    }
    Keys beyond;
    for (const auto& deployment : request.network->deployments) {
      const auto key = deployment.key();
      if (there.contains(key) || request.always || left.take(key)) {
        there.insert(key);
      } else {
        beyond.insert(key);
      }
    }
    all = solve::with_standby(all, without_processes(*request.network, beyond), catalog);
    if (request.always) {
      continue;
    }
    Readiness readiness = readiness_of(*request.network, all);
    readiness.ready = beyond.empty();
    if (!readiness.ready) {
      readiness.reason = std::to_string(beyond.size()) + " of its " +
                         std::to_string(request.network->deployments.size()) + " processes exceed " +
                         left.text();
    }
    plan.readiness.push_back(std::move(readiness));
  }
  plan.standby = subtract(all, controller);
  return plan;
}

model::Network already_present(const model::Network& standby, const model::Network& current) {
  model::Network kept;
  const auto processes = model::task_processes(standby);
  const auto current_processes = model::task_processes(current);
  const model::TaskIndex present(current);
  std::set<model::TaskId> ids;
  for (const auto& task : standby.tasks) {
    const model::Task* now = present.find(task.id);
    const auto process = processes.find(task.id);
    const auto current_process = current_processes.find(task.id);
    const bool same_place = (process == processes.end()) == (current_process == current_processes.end()) &&
                            (process == processes.end() || process->second == current_process->second);
    const bool stays = now != nullptr && now->component == task.component && same_place &&
                       now->same_configuration(task) && is_configured(now->state) && !is_error(now->state);
    if (stays) {
      kept.tasks.push_back(task);
      ids.insert(task.id);
    }
  }
  for (model::Deployment deployment : standby.deployments) {
    std::erase_if(deployment.tasks,
                  [&](const model::Placement& placement) { return !ids.contains(placement.task); });
    const bool there = std::any_of(current.deployments.begin(), current.deployments.end(),
                                   [&](const model::Deployment& other) {
                                     return other.key() == deployment.key() && other.same_process(deployment);
                                   });
    if (there) {
      kept.deployments.push_back(std::move(deployment));
    }
  }
  const auto connected = model::connection_texts(current);
  for (const auto& connection : standby.connections) {
    const bool there = connected.contains(to_string(connection));
    if (there && ids.contains(connection.from.task) && ids.contains(connection.to.task)) {
      kept.connections.push_back(connection);
    }
  }
  return kept;
}

model::Network with_properties_of(const model::Network& seen, model::Network controller) {
  const model::TaskIndex present(seen);
  for (auto& task : controller.tasks) {
    const model::Task* observed = present.find(task.id);
    if (observed != nullptr && observed->component == task.component) {
      task.properties = observed->properties;
    }
  }
  return controller;
}

}  // namespace segue::runtime::detail

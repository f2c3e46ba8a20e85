// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/leftovers.hpp>

#include <segue/task_host/full_id.hpp>

namespace segue::runtime::detail {

namespace {

bool is_leftover(const model::TaskId& id) {
  return task_host::split_id(id).process.has_value();
}

}  // namespace

std::set<model::TaskId> idle_tasks(const model::Network& current, const model::Network& controller) {
  std::set<model::TaskId> idle;
  for (const auto& task : current.tasks) {
    idle.insert(task.id);
  }
  for (const auto& task : controller.tasks) {
    idle.erase(task.id);
  }
  return idle;
}

std::map<model::TaskId, model::TaskId> prepared_incarnations(const model::Network& current,
                                                             const model::Network& target) {
  std::map<model::TaskId, model::TaskId> prepared;
  const auto processes = model::task_processes(target);
  const model::TaskIndex wanted_tasks(target);
  for (const auto& task : current.tasks) {
    const auto [plain, process] = task_host::split_id(task.id);
    if (!process || wanted_tasks.find(plain) == nullptr) {
      continue;
    }
    const auto wanted = processes.find(plain);
    const bool fits = wanted == processes.end() ? process->is_runtime() : wanted->second == *process;
    if (fits) {
      prepared.emplace(plain, task.id);
    }
  }
  return prepared;
}

model::Network without_leftover_incarnations(model::Network network) {
  std::erase_if(network.tasks, [](const model::Task& task) { return is_leftover(task.id); });
  std::erase_if(network.connections, [](const model::Connection& connection) {
    return is_leftover(connection.from.task) || is_leftover(connection.to.task);
  });
  for (auto& deployment : network.deployments) {
    std::erase_if(deployment.tasks,
                  [](const model::Placement& placement) { return is_leftover(placement.task); });
  }
  return network;
}

}  // namespace segue::runtime::detail

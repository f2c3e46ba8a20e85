// SPDX-License-Identifier: Apache-2.0
#include <segue/solve/placement_index.hpp>
#include <segue/solve/transition_index.hpp>

namespace segue::solve::detail {

PlacementIndex::PlacementIndex(const model::Network& network) {
  tasks_.reserve(network.tasks.size());
  for (const model::Task& task : network.tasks)
    tasks_.emplace(task.id.str(), &task);
  for (const model::Deployment& process : network.deployments) {
    for (const model::Placement& placement : process.tasks) {
      const std::string& name = placement.name.empty() ? placement.task.str() : placement.name;
      places_.emplace(placement.task.str(), TaskLocation{process.key(), name});
    }
  }
  for (const model::Task& task : network.tasks)
    occupants_.emplace(place_of(task.id), &task);
}

const model::Task* PlacementIndex::task(const model::TaskId& id) const {
  const auto found = tasks_.find(id.str());
  return found == tasks_.end() ? nullptr : found->second;
}

TaskLocation PlacementIndex::place_of(const model::TaskId& id) const {
  const auto found = places_.find(id.str());
  return found == places_.end() ? TaskLocation{{}, id.str()} : found->second;
}

const model::Task* PlacementIndex::occupant(const TaskLocation& place) const {
  const auto found = occupants_.find(place);
  return found == occupants_.end() ? nullptr : found->second;
}

std::vector<std::string> exclusive_devices(const model::Task& task, const ComponentFacts& component,
                                           const model::DeploymentKey& process) {
  std::vector<std::string> devices = task.exclusive;
  if (component.model != nullptr) {
    devices.insert(devices.end(), component.model->exclusive.begin(), component.model->exclusive.end());
  }
  for (std::string& device : devices)
    device = device_key(process.is_runtime() ? model::kLocalHost : process.host, device);
  return devices;
}

}  // namespace segue::solve::detail

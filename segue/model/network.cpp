// SPDX-License-Identifier: Apache-2.0
#include <segue/model/network.hpp>

#include <algorithm>
#include <tuple>

namespace segue::model {

bool operator==(const Task& a, const Task& b) {
  return a.id == b.id && a.component == b.component && a.state == b.state && a.same_configuration(b) &&
         a.takes_over == b.takes_over && a.on_failure == b.on_failure;
}

bool Task::same_configuration(const Task& other) const {
  return config_names == other.config_names && activity == other.activity && exclusive == other.exclusive &&
         properties == other.properties;
}

bool Deployment::same_process(const Deployment& other) const {
  auto attributes = [](const Deployment& d) {
    return std::tie(d.host, d.process, d.deployer, d.scheduler, d.priority, d.cpus, d.optional, d.environment,
                    d.libraries);
  };
  return attributes(*this) == attributes(other) && limits == other.limits;
}

bool operator==(const Deployment& a, const Deployment& b) {
  return a.same_process(b) && a.tasks == b.tasks && a.on_failure == b.on_failure;
}

const Task* Network::find_task(const TaskId& id) const {
  auto found = std::ranges::find(tasks, id, &Task::id);
  return found == tasks.end() ? nullptr : &*found;
}

Task* Network::find_task(const TaskId& id) {
  auto found = std::ranges::find(tasks, id, &Task::id);
  return found == tasks.end() ? nullptr : &*found;
}

TaskIndex::TaskIndex(const Network& network) {
  tasks_.reserve(network.tasks.size());
  for (const auto& task : network.tasks) {
    tasks_.try_emplace(task.id.str(), &task);
  }
}

const Task* TaskIndex::find(const TaskId& id) const {
  const auto found = tasks_.find(id.str());
  return found == tasks_.end() ? nullptr : found->second;
}

bool operator==(const Network& a, const Network& b) {
  return a.name == b.name && a.tasks == b.tasks && a.deployments == b.deployments &&
         a.connections == b.connections;
}

std::string to_string(const PortRef& ref) {
  return ref.task.str() + "." + ref.port;
}

std::string to_string(const DeploymentKey& key) {
  return key.is_runtime() ? key.host.str() + "/(the runtime's own process)"
                          : key.host.str() + "/" + key.process.str();
}

std::string to_string(const Connection& connection) {
  std::string text = to_string(connection.from) + " -> " + to_string(connection.to);
  const Policy& policy = connection.policy;
  std::vector<std::string> extras;
  if (policy.kind != BufferKind::Data) {
    extras.push_back(std::string(to_string(policy.kind)) + " of " + std::to_string(policy.size));
  }
  if (policy.transport != Transport::Automatic) extras.emplace_back(to_string(policy.transport));
  if (policy.init) extras.emplace_back("init");
  for (std::size_t i = 0; i < extras.size(); ++i)
    text += (i == 0 ? " (" : ", ") + extras[i];
  return extras.empty() ? text : text + ")";
}

std::map<TaskId, DeploymentKey> task_processes(const Network& network) {
  std::map<TaskId, DeploymentKey> processes;
  for (const auto& deployment : network.deployments) {
    for (const auto& placement : deployment.tasks) {
      processes.emplace(placement.task, deployment.key());
    }
  }
  return processes;
}

}  // namespace segue::model

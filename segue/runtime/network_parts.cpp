// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/network_parts.hpp>
#include <segue/task_host/full_id.hpp>

#include <variant>

namespace segue::runtime::detail {

void NetworkParts::add(const model::Network& network) {
  for (const auto& task : network.tasks) {
    tasks_.insert(task_host::plain_id(task.id));
  }
  for (const auto& deployment : network.deployments) {
    processes_.insert(deployment.key());
  }
}

bool NetworkParts::has(const model::TaskId& task) const {
  return tasks_.contains(task_host::plain_id(task));
}

bool NetworkParts::are_independent_of(const model::Action& action) const {
  struct Visitor {
    const NetworkParts& self;
    bool operator()(const model::TaskAction& what) const { return !self.has(what.task); }
    bool operator()(const model::CallAction& what) const { return !self.has(what.task); }
    bool operator()(const model::HandOverAction& what) const {
      return !self.has(what.from) && !self.has(what.to);
    }
    bool operator()(const model::ConnectionAction& what) const {
      return !self.has(what.connection.from.task) || !self.has(what.connection.to.task);
    }
    bool operator()(const model::DeploymentAction& what) const {
      return !self.processes_.contains(what.deployment.key());
    }
    bool operator()(const model::ConfigAction& /*what*/) const { return false; }
  };
  return std::visit(Visitor{*this}, action.what);
}

model::Network without_processes(model::Network network, const std::set<model::DeploymentKey>& processes) {
  std::set<model::TaskId> gone;
  std::erase_if(network.deployments, [&](const model::Deployment& deployment) {
    if (!processes.contains(deployment.key())) {
      return false;
    }
    for (const auto& placement : deployment.tasks) {
      gone.insert(placement.task);
    }
    return true;
  });
  std::erase_if(network.tasks, [&](const model::Task& task) { return gone.contains(task.id); });
  std::erase_if(network.connections, [&](const model::Connection& connection) {
    return gone.contains(connection.from.task) || gone.contains(connection.to.task);
  });
  return network;
}

}  // namespace segue::runtime::detail

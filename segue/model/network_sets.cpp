// SPDX-License-Identifier: Apache-2.0
#include <segue/model/network_sets.hpp>

#include <algorithm>
#include <map>
#include <set>
#include <string>

namespace segue::model {

namespace {

std::set<TaskId> ids_of(const Network& network) {
  std::set<TaskId> ids;
  for (const auto& task : network.tasks) {
    ids.insert(task.id);
  }
  return ids;
}

std::map<DeploymentKey, std::size_t> places_of(const Network& network) {
  std::map<DeploymentKey, std::size_t> places;
  for (std::size_t i = 0; i < network.deployments.size(); ++i) {
    places.emplace(network.deployments[i].key(), i);
  }
  return places;
}

void add_placements(Deployment& deployment, const Deployment& other) {
  std::set<TaskId> known;
  for (const Placement& mine : deployment.tasks) {
    known.insert(mine.task);
  }
  for (const Placement& placement : other.tasks) {
    if (known.insert(placement.task).second) {
      deployment.tasks.push_back(placement);
    }
  }
}

}  // namespace

std::set<std::string> connection_texts(const Network& network) {
  std::set<std::string> all;
  for (const auto& connection : network.connections) {
    all.insert(to_string(connection));
  }
  return all;
}

Network unite(Network first, const Network& second) {
  const auto ids = ids_of(first);
  for (const auto& task : second.tasks) {
    if (!ids.contains(task.id)) {
      first.tasks.push_back(task);
    }
  }
  const auto places = places_of(first);
  for (const auto& deployment : second.deployments) {
    const auto found = places.find(deployment.key());
    if (found == places.end()) {
      first.deployments.push_back(deployment);
    } else {
      add_placements(first.deployments[found->second], deployment);
    }
  }
  const auto known = connection_texts(first);
  for (const auto& connection : second.connections) {
    if (!known.contains(to_string(connection))) {
      first.connections.push_back(connection);
    }
  }
  return first;
}

Network subtract(const Network& all, const Network& part) {
  Network rest;
  const auto ids = ids_of(part);
  std::set<TaskId> left;
  for (const auto& task : all.tasks) {
    if (!ids.contains(task.id)) {
      rest.tasks.push_back(task);
      left.insert(task.id);
    }
  }
  const auto places = places_of(part);
  for (Deployment deployment : all.deployments) {
    const bool common = places.contains(deployment.key());
    std::erase_if(deployment.tasks,
                  [&](const Placement& placement) { return !left.contains(placement.task); });
    if (!common || !deployment.tasks.empty()) {
      rest.deployments.push_back(std::move(deployment));
    }
  }
  const auto known = connection_texts(part);
  for (const auto& connection : all.connections) {
    if (!known.contains(to_string(connection))) {
      rest.connections.push_back(connection);
    }
  }
  return rest;
}

Network without_hosts(Network network, const std::set<HostName>& hosts) {
  if (hosts.empty()) {
    return network;
  }
  const auto processes = task_processes(network);
  const auto is_there = [&](const TaskId& task) {
    const auto process = processes.find(task);
    return process != processes.end() && hosts.contains(process->second.host);
  };
  std::erase_if(network.connections, [&](const Connection& connection) {
    return is_there(connection.from.task) || is_there(connection.to.task);
  });
  std::erase_if(network.tasks, [&](const Task& task) { return is_there(task.id); });
  std::erase_if(network.deployments,
                [&](const Deployment& deployment) { return hosts.contains(deployment.host); });
  return network;
}

bool includes(const Network& all, const Network& part) {
  // The union equals `all` unless `part` has something that `all` lacks or has in another form.
  Network both = unite(part, all);
  both.name = all.name;
  return equivalent(both, all);
}

}  // namespace segue::model

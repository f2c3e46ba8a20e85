// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/component_model.hpp>
#include <segue/model/network.hpp>

#include <algorithm>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

/// Pairs of networks for the solver: the running one, in any state, and the target. They share names on
/// purpose: ids change components and processes, placements change tasks, devices change holders. All results
/// are valid, and a seed reproduces them.
namespace segue::testing {

struct PairShape {
  int tasks = 7;
  int processes = 3;
  int connections = 9;
  bool errors = true;           ///< running tasks may be in error
  bool devices = true;          ///< exclusive ones
  bool odd_names = true;        ///< names in processes that are not ids
  bool foreign = true;          ///< processes of another deployer
  bool same_processes = false;  ///< processes never change
};

struct NetworkPair {
  model::ComponentCatalog catalog;
  model::Network current;
  model::Network target;
};

class PairGenerator {
 public:
  PairGenerator(std::uint64_t seed, const PairShape& shape) : random_(seed), shape_(shape) {}

  NetworkPair make() {
    NetworkPair pair;
    pair.catalog = catalog();
    pair.current = network("now", pair.catalog);
    pair.target = one_in(4) ? network("then", pair.catalog) : variation(pair);
    if (shape_.errors) disturb(pair);
    return pair;
  }

  static model::ComponentCatalog catalog() {
    using model::Direction;
    model::ComponentCatalog catalog;
    for (int i = 0; i < 3; ++i) {
      model::ComponentModel component;
      component.name = model::ComponentName("demo::C" + std::to_string(i));
      component.ports = {{"out", Direction::Output, "", false, false, ""},
                         {"in", Direction::Input, "", false, false, ""}};
      if (i > 0) {
        component.ports.push_back({"late", Direction::Output, "", true, false, ""});
        component.ports.push_back({"dyn_[a-z]+", Direction::Input, "", true, true, ""});
      }
      component.properties = {{"gain", "", {}, true, ""}, {"mode", "", {}, false, ""}};
      if (i == 2) component.exclusive = {"arm"};
      catalog.add(component);
    }
    return catalog;
  }

 private:
  int up_to(int most) {
    return most <= 0 ? 0 : static_cast<int>(random_() % (static_cast<std::uint64_t>(most) + 1));
  }
  bool one_in(int chances) { return up_to(chances - 1) == 0; }

  model::Network network(const char* name, const model::ComponentCatalog& catalog) {
    model::Network network;
    network.name = model::NetworkName(name);
    for (int i = 0; i < shape_.tasks; ++i) {
      if (!one_in(3)) network.tasks.push_back(task(i));
    }
    std::shuffle(network.tasks.begin(), network.tasks.end(), random_);
    for (int i = 0; i < shape_.processes; ++i) {
      if (!one_in(3)) network.deployments.push_back(process(i));
    }
    place_tasks(network);
    settle_devices(network, catalog);
    wire(network, catalog);
    return network;
  }

  model::Task task(int number) {
    model::Task task;
    task.id = model::TaskId("t" + std::to_string(number));
    // C3 is unknown to the catalog.
    task.component = model::ComponentName("demo::C" + std::to_string(one_in(5) ? up_to(3) : number % 3));
    task.state = one_in(3) ? static_cast<TaskState>(up_to(2)) : TaskState::Running;
    configure(task);
    return task;
  }

  void configure(model::Task& task) {
    if (one_in(2)) task.properties.as_map().set("gain", up_to(2));
    if (one_in(2)) task.properties.as_map().set("mode", up_to(1));
    if (one_in(8)) task.config_names = {"fast"};
    if (one_in(8)) task.takes_over = model::TaskId("t" + std::to_string(up_to(shape_.tasks - 1)));
    if (one_in(6)) task.on_failure = static_cast<model::FailurePolicy>(up_to(3));
    if (shape_.devices && one_in(3)) task.exclusive = {"/dev/" + std::to_string(up_to(1))};
  }

  model::Deployment process(int number) {
    model::Deployment process;
    process.process = model::ProcessName("p" + std::to_string(number));
    if (shape_.foreign && number == 1) process.deployer = "orogen";
    if (!shape_.same_processes && one_in(6)) process.priority = 1;
    if (!shape_.same_processes && one_in(12)) process.limits.core = 0;
    if (!shape_.same_processes && one_in(12)) process.optional = true;
    return process;
  }

  void place_tasks(model::Network& network) {
    for (model::Deployment& process : network.deployments)
      process.tasks.clear();
    const int processes = static_cast<int>(network.deployments.size());
    if (processes == 0) return;
    for (const model::Task& task : network.tasks) {
      if (one_in(4)) continue;
      auto& placements = network.deployments[static_cast<std::size_t>(up_to(processes - 1))].tasks;
      std::string name = task.id.str();
      if (shape_.odd_names && one_in(3)) name = "name" + std::to_string(up_to(1));
      const bool taken =
          std::any_of(placements.begin(), placements.end(), [&](const auto& s) { return s.name == name; });
      placements.push_back({task.id, taken ? task.id.str() : name});
    }
    if (one_in(4)) network.deployments.front().tasks.push_back({model::TaskId("absent"), "absent"});
  }

  static std::set<std::string> devices_of(const model::Task& task, const model::ComponentCatalog& catalog) {
    std::set<std::string> devices(task.exclusive.begin(), task.exclusive.end());
    if (const auto* model = catalog.find(task.component)) {
      devices.insert(model->exclusive.begin(), model->exclusive.end());
    }
    return devices;
  }

  /// Of the tasks that claim the same device only the first is configured.
  static void settle_devices(model::Network& network, const model::ComponentCatalog& catalog) {
    std::set<std::string> held;
    for (model::Task& task : network.tasks) {
      if (!is_configured(task.state) && task.state != TaskState::Fatal) continue;
      const auto wanted = devices_of(task, catalog);
      const bool free = std::none_of(wanted.begin(), wanted.end(),
                                     [&](const auto& device) { return held.contains(device); });
      if (free) {
        held.insert(wanted.begin(), wanted.end());
      } else {
        task.state = TaskState::PreOperational;
      }
    }
  }

  static bool has_late_ports(const model::Task& task, const model::ComponentCatalog& catalog) {
    const auto* model = catalog.find(task.component);
    return model != nullptr && model->has_dynamic_ports() && is_configured(task.state);
  }

  /// Adds connections up to the wanted number; removes those that the tasks no longer allow.
  void wire(model::Network& network, const model::ComponentCatalog& catalog) {
    std::set<std::pair<model::PortRef, model::PortRef>> taken;
    std::erase_if(network.connections,
                  [&](const model::Connection& c) { return !fits(network, c, catalog); });
    for (const auto& connection : network.connections)
      taken.insert({connection.from, connection.to});
    if (network.tasks.empty()) return;
    while (static_cast<int>(network.connections.size()) < shape_.connections) {
      if (one_in(shape_.connections)) return;
      model::Connection connection;
      const int last = static_cast<int>(network.tasks.size()) - 1;
      const model::Task& from = network.tasks[static_cast<std::size_t>(up_to(last))];
      const model::Task& to = network.tasks[static_cast<std::size_t>(up_to(last))];
      connection.from = {from.id, one_in(2) && has_late_ports(from, catalog) ? "late" : "out"};
      connection.to = {to.id, one_in(2) && has_late_ports(to, catalog) ? "dyn_x" : "in"};
      if (one_in(3)) connection.policy = {BufferKind::Buffer, static_cast<std::size_t>(1 + up_to(1))};
      if (taken.insert({connection.from, connection.to}).second) network.connections.push_back(connection);
    }
  }

  static bool fits(const model::Network& network, const model::Connection& connection,
                   const model::ComponentCatalog& catalog) {
    const auto* from = network.find_task(connection.from.task);
    const auto* to = network.find_task(connection.to.task);
    if (from == nullptr || to == nullptr) return false;
    return (connection.from.port == "out" || has_late_ports(*from, catalog)) &&
           (connection.to.port == "in" || has_late_ports(*to, catalog));
  }

  model::Network variation(const NetworkPair& pair) {
    model::Network network = pair.current;
    network.name = model::NetworkName("then");
    const int changes = 1 + up_to(6);
    for (int i = 0; i < changes; ++i)
      vary(network);
    std::set<model::TaskId> left;
    for (const auto& task : network.tasks)
      left.insert(task.id);
    for (auto& process : network.deployments) {
      std::erase_if(process.tasks, [&](const auto& placement) { return !left.contains(placement.task); });
    }
    settle_devices(network, pair.catalog);
    wire(network, pair.catalog);
    return network;
  }

  void vary(model::Network& network) {
    if (network.tasks.empty() || one_in(8)) {
      add_new_task(network);
      return;
    }
    const auto number = static_cast<std::size_t>(up_to(static_cast<int>(network.tasks.size()) - 1));
    model::Task& task = network.tasks[number];
    switch (up_to(8)) {
      case 0:
        network.tasks.erase(network.tasks.begin() + static_cast<std::ptrdiff_t>(number));
        return;
      case 1:
        task.component = model::ComponentName("demo::C" + std::to_string(up_to(3)));
        return;
      case 2:
        task.state = static_cast<TaskState>(up_to(2));
        return;
      case 3:
        configure(task);
        return;
      case 4:
        task.properties.as_map().set("gain", 7);
        return;
      case 5:
        place_tasks(network);
        return;
      case 6:
        if (!network.connections.empty()) network.connections.pop_back();
        return;
      case 7:
        if (!network.connections.empty()) network.connections.front().policy.size = 9;
        if (!network.connections.empty())
          network.connections.front().policy.kind = BufferKind::CircularBuffer;
        return;
      default:
        if (!network.deployments.empty() && !shape_.same_processes) network.deployments.back().priority += 1;
    }
  }

  void add_new_task(model::Network& network) {
    const int number = up_to(shape_.tasks - 1);
    if (network.find_task(model::TaskId("t" + std::to_string(number))) == nullptr) {
      network.tasks.push_back(task(number));
    }
  }

  /// Adds errors, but none that is fatal in the runtime's own process, since there is no transition from it.
  void disturb(NetworkPair& pair) {
    std::set<model::TaskId> deployed;
    for (const auto& process : pair.current.deployments) {
      for (const auto& placement : process.tasks)
        deployed.insert(placement.task);
    }
    for (model::Task& task : pair.current.tasks) {
      if (!one_in(4)) continue;
      const bool fatal = deployed.contains(task.id) && one_in(3);
      task.state = fatal ? TaskState::Fatal : static_cast<TaskState>(3 + up_to(1));
    }
    settle_devices(pair.current, pair.catalog);
  }

  std::mt19937_64 random_;
  PairShape shape_;
};

inline NetworkPair random_pair(std::uint64_t seed, const PairShape& shape = {}) {
  return PairGenerator(seed, shape).make();
}

}  // namespace segue::testing

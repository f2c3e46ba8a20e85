// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/network.hpp>
#include <segue/solve/component_facts.hpp>

#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

/// Where each task of one network lives, for functions that compose networks. The solver itself has its own
/// index.
namespace segue::solve::detail {

/// A place: a process, and a name inside it.
struct TaskLocation {
  model::DeploymentKey process;  ///< is_runtime(): the runtime's own
  std::string name;
  friend bool operator==(const TaskLocation&, const TaskLocation&) = default;
};

/// Refers to the network, which must outlive it.
class PlacementIndex {
 public:
  explicit PlacementIndex(const model::Network& network);
  [[nodiscard]] const model::Task* task(const model::TaskId& id) const;
  [[nodiscard]] bool has_task(const model::TaskId& id) const { return task(id) != nullptr; }
  /// Also of tasks that the network lacks, if a deployment names them.
  [[nodiscard]] TaskLocation place_of(const model::TaskId& id) const;
  /// The task of the network in that place, or nullptr.
  [[nodiscard]] const model::Task* occupant(const TaskLocation& place) const;
  [[nodiscard]] bool is_taken(const TaskLocation& place) const { return occupant(place) != nullptr; }

 private:
  struct TaskLocationHash {
    std::size_t operator()(const TaskLocation& place) const noexcept {
      return model::combine_hashes(std::hash<model::DeploymentKey>{}(place.process),
                                   std::hash<std::string>{}(place.name));
    }
  };
  std::unordered_map<std::string_view, const model::Task*> tasks_;
  std::unordered_map<std::string_view, TaskLocation> places_;  ///< of those that deployments name
  std::unordered_map<TaskLocation, const model::Task*, TaskLocationHash> occupants_;
};

/// The devices that the task and its component claim in that process, as names that are unique over all
/// hosts.
std::vector<std::string> exclusive_devices(const model::Task& task, const ComponentFacts& component,
                                           const model::DeploymentKey& process);

}  // namespace segue::solve::detail

// SPDX-License-Identifier: Apache-2.0
#include <segue/solve/component_facts.hpp>
#include <segue/solve/placement_index.hpp>
#include <segue/solve/plan.hpp>
#include <segue/solve/standby_network.hpp>
#include <segue/solve/transition_index.hpp>

#include <string>
#include <unordered_map>
#include <unordered_set>

namespace segue::solve {

namespace {

using namespace detail;

class StandbyBuilder {
 public:
  StandbyBuilder(const model::Network& running, const model::Network& wanted,
                 const model::ComponentCatalog& catalog)
      : running_(running),
        wanted_(wanted),
        result_(running),
        components_(catalog),
        placements_(running),
        wanted_placements_(wanted) {}

  model::Network build() {
    hold_devices();
    add_processes();
    find_full_processes();
    for (const model::Task& task : wanted_.tasks)
      add_task(task);
    for (const model::Connection& connection : wanted_.connections)
      add_connection(connection);
    return std::move(result_);
  }

 private:
  /// Collects the held devices. A task in Fatal may hold its devices until its process has ended, and no new
  /// task is placed in that process.
  void hold_devices() {
    for (const model::Task& task : running_.tasks) {
      if (task.state == TaskState::Fatal) others_.insert(placements_.place_of(task.id).process);
      if (!is_configured(task.state) && task.state != TaskState::Fatal) continue;
      for (std::string& device : devices_of(task, placements_))
        held_.insert(std::move(device));
    }
  }

  std::vector<std::string> devices_of(const model::Task& task, const PlacementIndex& placements) {
    return exclusive_devices(task, components_.of(task.component), placements.place_of(task.id).process);
  }

  void add_processes() {
    for (std::size_t i = 0; i < result_.deployments.size(); ++i)
      processes_.emplace(result_.deployments[i].key(), i);
    for (const model::Deployment& process : wanted_.deployments) {
      const auto [place, is_new] = processes_.emplace(process.key(), result_.deployments.size());
      if (is_new) {
        result_.deployments.push_back(process);
        result_.deployments.back().tasks.clear();
      } else if (!result_.deployments[place->second].same_process(process)) {
        others_.insert(process.key());
      }
    }
  }

  /// Processes with a fixed set of tasks are replaced if another component is wanted there.
  void find_full_processes() {
    for (const model::Task& task : wanted_.tasks) {
      const TaskLocation place = wanted_placements_.place_of(task.id);
      const model::Task* occupant = placements_.occupant(place);
      if (occupant == nullptr || place.process.is_runtime() || occupant->component == task.component)
        continue;
      const std::size_t process = processes_.at(place.process);
      if (!holds_any_component(result_.deployments[process])) others_.insert(place.process);
    }
  }

  void add_task(const model::Task& task) {
    const TaskLocation place = wanted_placements_.place_of(task.id);
    const bool can_be =
        !placements_.has_task(task.id) && !others_.contains(place.process) && !placements_.is_taken(place);
    if (!can_be) return;
    model::Task created = task;
    created.state =
        is_configured(task.state) && take_devices(task) ? TaskState::Stopped : TaskState::PreOperational;
    forget_empty_placement(task.id);
    if (!place.process.is_runtime()) {
      result_.deployments[processes_.at(place.process)].tasks.push_back({task.id, place.name});
    }
    created_.emplace(task.id.str(), created.state);
    result_.tasks.push_back(std::move(created));
  }

  /// Removes a placement without a task: deployments may name tasks that their network lacks.
  void forget_empty_placement(const model::TaskId& id) {
    const auto process = processes_.find(placements_.place_of(id).process);
    if (process == processes_.end()) return;
    std::erase_if(result_.deployments[process->second].tasks,
                  [&](const model::Placement& placement) { return placement.task == id; });
  }

  /// Reserves all devices of the task, or none if one is held.
  bool take_devices(const model::Task& task) {
    std::vector<std::string> wanted = devices_of(task, wanted_placements_);
    for (const std::string& device : wanted) {
      if (held_.contains(device)) return false;
    }
    for (std::string& device : wanted)
      held_.insert(std::move(device));
    return true;
  }

  void add_connection(const model::Connection& connection) {
    if (has_port(connection.from, model::Direction::Output) &&
        has_port(connection.to, model::Direction::Input)) {
      result_.connections.push_back(connection);
    }
  }

  bool has_port(const model::PortRef& port, model::Direction direction) {
    const auto created = created_.find(port.task.str());
    if (created == created_.end()) return false;
    const model::Task& task = *wanted_placements_.task(port.task);
    return is_configured(created->second) ||
           !is_dynamic(components_.of(task.component), port.port, direction);
  }

  const model::Network& running_;
  const model::Network& wanted_;
  model::Network result_;  ///< grows, so there must be no pointers into it
  KnownComponents components_;
  PlacementIndex placements_;
  PlacementIndex wanted_placements_;
  std::unordered_set<std::string> held_;                             ///< devices
  std::unordered_map<model::DeploymentKey, std::size_t> processes_;  ///< of the result
  std::unordered_set<model::DeploymentKey> others_;                  ///< processes that cannot take new tasks
  std::unordered_map<std::string_view, TaskState> created_;          ///< new tasks, by id
};

}  // namespace

model::Network with_standby(const model::Network& running, const model::Network& wanted,
                            const model::ComponentCatalog& catalog) {
  return StandbyBuilder(running, wanted, catalog).build();
}

}  // namespace segue::solve

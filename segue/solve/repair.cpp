// SPDX-License-Identifier: Apache-2.0
#include <segue/solve/component_facts.hpp>
#include <segue/solve/placement_index.hpp>
#include <segue/solve/plan.hpp>
#include <segue/solve/repair.hpp>

#include <algorithm>
#include <string>
#include <unordered_map>
#include <unordered_set>

namespace segue::solve {

namespace {

using namespace detail;

/// Widens the scope; it only grows.
class Scope {
 public:
  Scope(const RepairScope& scope, const model::Network& observed, const model::Network& belief,
        const model::ComponentCatalog& catalog)
      : observed_(observed), belief_(belief), components_(catalog), now_(observed), then_(belief) {
    for (const model::Deployment& process : observed.deployments)
      observed_processes_.emplace(process.key(), &process);
    tasks_.insert(scope.tasks.begin(), scope.tasks.end());
    for (const model::DeploymentKey& process : scope.processes)
      add(process);
    find_holders();
    std::size_t size = 0;
    do {
      size = tasks_.size() + processes_.size();
      widen();
    } while (tasks_.size() + processes_.size() > size);
  }

  [[nodiscard]] bool has(const model::TaskId& task) const { return tasks_.contains(task); }
  [[nodiscard]] bool has(const model::DeploymentKey& process) const { return processes_.contains(process); }
  [[nodiscard]] const PlacementIndex& now() const { return now_; }
  [[nodiscard]] const PlacementIndex& then() const { return then_; }
  ComponentFacts component(const model::Task& task) { return components_.of(task.component); }

  [[nodiscard]] RepairScope listed() const {
    RepairScope list;
    for (const model::Task& task : observed_.tasks) {
      if (has(task.id)) list.tasks.push_back(task.id);
    }
    for (const model::Task& task : belief_.tasks) {
      if (has(task.id) && !now_.has_task(task.id)) list.tasks.push_back(task.id);
    }
    list.processes.assign(processes_.begin(), processes_.end());
    std::sort(list.processes.begin(), list.processes.end());
    return list;
  }

 private:
  void add(const model::DeploymentKey& process) {
    if (!process.is_runtime()) processes_.insert(process);
  }

  /// Finds the present holder of each device.
  void find_holders() {
    for (const model::Task& task : observed_.tasks) {
      if (!is_configured(task.state) && task.state != TaskState::Fatal) continue;
      for (const std::string& device : devices_of(task, now_))
        holders_.emplace(device, &task);
    }
  }

  std::vector<std::string> devices_of(const model::Task& task, const PlacementIndex& placements) {
    return exclusive_devices(task, components_.of(task.component), placements.place_of(task.id).process);
  }

  void widen() {
    for (const model::Task& task : observed_.tasks) {
      const model::DeploymentKey process = now_.place_of(task.id).process;
      if (has(process)) tasks_.insert(task.id);
      if (has(task.id) && task.state == TaskState::Fatal) add(process);
    }
    for (const model::Task& task : belief_.tasks) {
      if (has(then_.place_of(task.id).process)) tasks_.insert(task.id);
      if (has(task.id)) make_room(task);
    }
  }

  /// Adds tasks that occupy the task's placement or hold its devices.
  void make_room(const model::Task& task) {
    const TaskLocation place = then_.place_of(task.id);
    if (const model::Task* occupant = now_.occupant(place)) {
      tasks_.insert(occupant->id);
      if (occupant->component != task.component && !holds_any(place.process)) add(place.process);
    }
    if (!is_configured(task.state)) return;
    for (const std::string& device : devices_of(task, then_)) {
      const auto holder = holders_.find(device);
      if (holder != holders_.end()) tasks_.insert(holder->second->id);
    }
  }

  [[nodiscard]] bool holds_any(const model::DeploymentKey& process) const {
    const auto found = observed_processes_.find(process);
    return found == observed_processes_.end() || holds_any_component(*found->second);
  }

  const model::Network& observed_;
  const model::Network& belief_;
  KnownComponents components_;
  PlacementIndex now_;
  PlacementIndex then_;
  std::unordered_map<model::DeploymentKey, const model::Deployment*> observed_processes_;
  std::unordered_map<std::string, const model::Task*> holders_;
  std::unordered_set<model::TaskId> tasks_;
  std::unordered_set<model::DeploymentKey> processes_;
};

/// Builds the target: the observed network with the scope replaced by its form in the belief.
class Mixture {
 public:
  Mixture(Scope& scope, const model::Network& observed, const model::Network& belief)
      : scope_(scope), observed_(observed), belief_(belief) {}

  model::Network mix() {
    result_.name = belief_.name;
    add_processes();
    add_tasks();
    add_connections();
    return std::move(result_);
  }

 private:
  void add_processes() {
    for (const model::Deployment& process : observed_.deployments) {
      if (!scope_.has(process.key())) add(process);
    }
    std::unordered_set<model::DeploymentKey> needed;
    for (const model::Task& task : belief_.tasks) {
      if (scope_.has(task.id)) needed.insert(scope_.then().place_of(task.id).process);
    }
    for (const model::Deployment& process : belief_.deployments) {
      if (scope_.has(process.key()) || needed.contains(process.key())) add(process);
    }
  }

  void add(const model::Deployment& process) {
    if (!processes_.emplace(process.key(), result_.deployments.size()).second) return;
    result_.deployments.push_back(process);
    result_.deployments.back().tasks.clear();
  }

  void add_tasks() {
    for (const model::Task& task : observed_.tasks) {
      if (!scope_.has(task.id)) add(task, scope_.now().place_of(task.id));
    }
    for (const model::Task& task : belief_.tasks) {
      if (scope_.has(task.id)) add(task, scope_.then().place_of(task.id));
    }
  }

  void add(const model::Task& task, const TaskLocation& place) {
    if (!place.process.is_runtime()) {
      result_.deployments[processes_.at(place.process)].tasks.push_back({task.id, place.name});
    }
    result_.tasks.push_back(task);
    tasks_.insert(task.id);
  }

  void add_connections() {
    for (const model::Connection& connection : observed_.connections) {
      if (!concerns_scope(connection) && can_be(connection)) result_.connections.push_back(connection);
    }
    for (const model::Connection& connection : belief_.connections) {
      if (concerns_scope(connection) && can_be(connection)) result_.connections.push_back(connection);
    }
  }

  [[nodiscard]] bool concerns_scope(const model::Connection& connection) const {
    return scope_.has(connection.from.task) || scope_.has(connection.to.task);
  }

  bool can_be(const model::Connection& connection) {
    return has_port(connection.from, model::Direction::Output) &&
           has_port(connection.to, model::Direction::Input);
  }

  /// Whether the port exists: a task outside of the scope may be missing or lack its dynamic ports.
  bool has_port(const model::PortRef& port, model::Direction direction) {
    if (!tasks_.contains(port.task)) return false;
    if (scope_.has(port.task)) return true;
    const model::Task& task = *scope_.now().task(port.task);
    return is_configured(task.state) || !is_dynamic(scope_.component(task), port.port, direction);
  }

  Scope& scope_;
  const model::Network& observed_;
  const model::Network& belief_;
  model::Network result_;
  std::unordered_map<model::DeploymentKey, std::size_t> processes_;  ///< of the result
  std::unordered_set<model::TaskId> tasks_;                          ///< of the result
};

}  // namespace

RepairScope widened(const RepairScope& scope, const model::Network& observed, const model::Network& belief,
                    const model::ComponentCatalog& catalog) {
  return Scope(scope, observed, belief, catalog).listed();
}

Result<model::Transition> repair(const model::Network& observed, const model::Network& belief,
                                 const model::ComponentCatalog& catalog, const Options& options,
                                 const RepairScope& scope) {
  Scope touched(scope, observed, belief, catalog);
  const model::Network target = Mixture(touched, observed, belief).mix();
  return diff(observed, target, catalog, options);
}

}  // namespace segue::solve

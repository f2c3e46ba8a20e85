// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/fault_owners.hpp>

#include <segue/model/controller_names.hpp>
#include <segue/model/network_sets.hpp>

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>
#include <variant>

namespace segue::runtime::detail {

FaultOwners::FaultOwners(const model::Network& running, const ControllerRegistry& known)
    : running_(running), names_(model::controllers_in(running.name.str())) {
  for (const auto& name : names_) {
    if (const auto controller = known.known(name)) {
      auto& tasks = tasks_[name];
      for (const auto& task : controller->tasks) {
        tasks.insert(task.id);
      }
    }
  }
}

std::vector<model::NetworkName> FaultOwners::of(const DetectedFault& fault) const {
  const auto tasks = tasks_of(fault);
  std::vector<model::NetworkName> with;
  std::ranges::copy_if(names_, std::back_inserter(with), [&](const model::NetworkName& name) {
    const auto found = tasks_.find(name);
    return found != tasks_.end() && std::ranges::any_of(tasks, [&](const model::TaskId& task) {
             return found->second.contains(task);
           });
  });
  return with.empty() ? names_ : with;
}

UnresolvedFault FaultOwners::unresolved(const DetectedFault& fault, std::string sentence) const {
  const auto* task = std::get_if<model::TaskId>(&fault.subject);
  return {std::move(sentence), of(fault), task == nullptr ? std::nullopt : std::optional(*task)};
}

std::vector<model::TaskId> FaultOwners::tasks_of(const DetectedFault& fault) const {
  if (const auto* task = std::get_if<model::TaskId>(&fault.subject)) return {*task};
  std::vector<model::TaskId> tasks;
  for (const auto& [placed, process] : model::task_processes(running_)) {
    if (process == std::get<model::DeploymentKey>(fault.subject)) tasks.push_back(placed);
  }
  return tasks;
}

}  // namespace segue::runtime::detail

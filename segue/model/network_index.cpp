// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/model/network_index.hpp>
#include <segue/model/port_pattern.hpp>

namespace segue::model::detail {
namespace {

constexpr std::size_t kMostCandidates = 10'000;

std::size_t side(Direction direction) {
  return static_cast<std::size_t>(direction);
}

}  // namespace

ComponentIndex::ComponentIndex(const ComponentModel& model) : model_(&model) {
  for (const PortModel& port : model.ports) {
    if (port.pattern) {
      families_.at(side(port.direction)).push_back(&port);
    } else {
      ports_.at(side(port.direction)).try_emplace(port.name, &port);
    }
  }
  for (const PropertyModel& property : model.properties)
    properties_.try_emplace(property.name, &property);
}

std::vector<const PortModel*> ComponentIndex::find_ports(const std::string& name, Direction direction) const {
  const auto& fixed = ports_.at(side(direction));
  if (const auto found = fixed.find(name); found != fixed.end()) return {found->second};
  std::vector<const PortModel*> fitting;
  for (const PortModel* family : families_.at(side(direction))) {
    if (matches_port_pattern(family->name, name)) fitting.push_back(family);
  }
  return fitting;
}

const PropertyModel* ComponentIndex::find_property(const std::string& name) const {
  const auto found = properties_.find(name);
  return found == properties_.end() ? nullptr : found->second;
}

std::vector<std::string> ComponentIndex::port_names(Direction direction) const {
  std::vector<std::string> names;
  for (const PortModel& port : model_->ports) {
    if (port.direction == direction && !port.pattern) names.push_back(port.name);
  }
  return names;
}

std::vector<std::string> ComponentIndex::property_names() const {
  std::vector<std::string> names;
  for (const PropertyModel& property : model_->properties)
    names.push_back(property.name);
  return names;
}

NetworkIndex::NetworkIndex(const Network& network, const ComponentCatalog& catalog)
    : network_(network), tasks_(network) {
  for (const Task& task : network.tasks) {
    if (components_.contains(task.component)) continue;
    if (const ComponentModel* model = catalog.find(task.component)) {
      components_.try_emplace(task.component, *model);
    }
  }
  deployments_.reserve(network.tasks.size());
  for (const Deployment& deployment : network.deployments) {
    for (const Placement& placement : deployment.tasks)
      deployments_.try_emplace(placement.task.str(), &deployment);
  }
}

const Deployment* NetworkIndex::deployment(const TaskId& id) const {
  const auto found = deployments_.find(id.str());
  return found == deployments_.end() ? nullptr : found->second;
}

const HostName& NetworkIndex::host(const TaskId& id) const {
  const Deployment* holder = deployment(id);
  return holder == nullptr ? kLocalHost : holder->host;
}

const ComponentIndex* NetworkIndex::component(const ComponentName& name) const {
  const auto found = components_.find(name);
  return found == components_.end() ? nullptr : &found->second;
}

std::string NetworkIndex::task_suggestion(const std::string& name) const {
  if (network_.tasks.size() > kMostCandidates || suggestions_left_-- <= 0) return {};
  std::vector<std::string> candidates;
  candidates.reserve(network_.tasks.size());
  for (const Task& task : network_.tasks)
    candidates.push_back(task.id.str());
  return did_you_mean(name, candidates);
}

SourceLocation place(const SourceLocation& where, const Network& network) {
  return where.known() ? where : SourceLocation{network.file, 0, 0};
}

}  // namespace segue::model::detail

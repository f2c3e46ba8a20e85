// SPDX-License-Identifier: Apache-2.0
#include <segue/model/component_model.hpp>
#include <segue/model/port_pattern.hpp>

#include <algorithm>
#include <tuple>
#include <utility>

namespace segue::model {

std::string_view to_string(Direction direction) {
  return direction == Direction::Input ? "input" : "output";
}

std::vector<const PortModel*> ComponentModel::find_ports(std::string_view port, Direction direction) const {
  std::vector<const PortModel*> families;
  for (const PortModel& model : ports) {
    if (model.direction != direction) continue;
    if (!model.pattern && model.name == port) return {&model};
    if (model.pattern && matches_port_pattern(model.name, port)) families.push_back(&model);
  }
  return families;
}

const PortModel* ComponentModel::find_port(std::string_view port, Direction direction) const {
  const auto fitting = find_ports(port, direction);
  return fitting.empty() ? nullptr : fitting.front();
}

const PropertyModel* ComponentModel::find_property(std::string_view property) const {
  auto found = std::ranges::find(properties, property, &PropertyModel::name);
  return found == properties.end() ? nullptr : &*found;
}

const OperationModel* ComponentModel::find_operation(std::string_view operation) const {
  auto found = std::ranges::find(operations, operation, &OperationModel::name);
  return found == operations.end() ? nullptr : &*found;
}

bool ComponentModel::has_dynamic_ports() const {
  return std::ranges::any_of(ports, &PortModel::dynamic);
}

bool operator==(const ComponentModel& a, const ComponentModel& b) {
  auto all = [](const ComponentModel& m) {
    return std::tie(m.name, m.doc, m.library, m.abstract, m.ports, m.properties, m.operations, m.activity,
                    m.trigger_ports, m.descriptors, m.nominal_states, m.error_states, m.exclusive,
                    m.incomplete, m.parent, m.own_activity);
  };
  return all(a) == all(b);
}

void ComponentCatalog::add(ComponentModel model) {
  const bool has_state = std::ranges::any_of(model.ports, [](const PortModel& port) {
    return port.name == "state" && port.direction == Direction::Output && !port.pattern;
  });
  if (!has_state) {
    model.ports.push_back({"state", Direction::Output, "/int32_t", false, false, "the state of the task"});
  }
  ComponentName name = model.name;
  models_.insert_or_assign(std::move(name), std::move(model));
}

const ComponentModel* ComponentCatalog::find(const ComponentName& name) const {
  auto found = models_.find(name);
  return found == models_.end() ? nullptr : &found->second;
}

std::vector<const ComponentModel*> ComponentCatalog::all() const {
  std::vector<const ComponentModel*> result;
  result.reserve(models_.size());
  for (const auto& [name, model] : models_)
    result.push_back(&model);
  return result;
}

void ComponentCatalog::register_composite_types() {
  auto known = [this](const std::string& name) {
    if (!name.empty()) types_.find(name);
  };
  for (const auto& [name, model] : models_) {
    for (const PortModel& port : model.ports)
      known(port.type);
    for (const PropertyModel& property : model.properties)
      known(property.type);
    for (const OperationModel& operation : model.operations) {
      known(operation.result);
      for (const ArgumentModel& argument : operation.arguments)
        known(argument.type);
    }
  }
}

}  // namespace segue::model

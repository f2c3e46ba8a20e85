// SPDX-License-Identifier: Apache-2.0
#include <segue/model/component_parts.hpp>
#include <segue/model/port_pattern.hpp>

#include <algorithm>
#include <utility>

namespace segue::model::detail {

using type::Value;

namespace {

const Value& nothing() {
  static const Value null;
  return null;
}

std::string read_type(Fields& fields, ComponentModel& model, const Source& source) {
  const Value* type = fields.find("Type");
  if (type == nullptr) return {};
  return rock_type_name(scalar_text(*type).value_or(""), model, *type, source);
}

void read_ports(Fields& task, std::string_view key, Direction direction, ComponentModel& model,
                const Source& source) {
  for (const Value& item : task.entries(key)) {
    Fields fields(item, "an entry of " + quote(key) + " of " + task.what(), source);
    PortModel port;
    port.name = fields.required_name("Name");
    port.direction = direction;
    port.type = read_type(fields, model, source);
    port.doc = fields.text("Doc");
    fields.finish();
    if (!port.name.empty()) model.ports.push_back(std::move(port));
  }
}

/// Their names are expressions between slashes: "/^debug_/".
void read_families(Fields& task, std::string_view key, Direction direction, ComponentModel& model,
                   const Source& source) {
  for (const Value& item : task.entries(key)) {
    Fields fields(item, "an entry of " + quote(key) + " of " + task.what(), source);
    std::string expression = fields.text("Name");
    if (expression.size() >= 2 && expression.starts_with('/') && expression.ends_with('/')) {
      expression = expression.substr(1, expression.size() - 2);
    }
    PortModel port = rock_family(expression, direction, read_type(fields, model, source));
    port.doc = fields.text("Doc");
    fields.finish();
    if (auto usable = check_port_pattern(port.name); !usable) {
      source.error("bad-pattern", fields.what() + ": " + usable.error().message, item);
    }
    model.ports.push_back(std::move(port));
  }
}

void read_properties(Fields& task, ComponentModel& model, const Source& source) {
  for (const Value& item : task.entries("properties")) {
    Fields fields(item, "a property of " + task.what(), source);
    PropertyModel property;
    property.name = fields.required_name("Name");
    property.type = read_type(fields, model, source);
    property.doc = fields.text("Doc");
    property.live = fields.boolean("Dynamic", false);
    if (const Value* value = fields.find("DefaultVal")) {
      property.default_value = rock_default(*value, property, source);
    }
    fields.finish();
    if (!property.name.empty()) model.properties.push_back(std::move(property));
  }
}

void read_operations(Fields& task, ComponentModel& model, const Source& source) {
  for (const Value& item : task.entries("operations")) {
    Fields fields(item, "an operation of " + task.what(), source);
    OperationModel operation;
    operation.name = fields.required_name("Name");
    operation.doc = fields.text("Doc");
    const Value* result = fields.find("Return", Value::Kind::Map);
    Fields result_fields(result == nullptr ? nothing() : *result, "the result of " + fields.what(), source);
    operation.result = read_type(result_fields, model, source);
    for (const Value& argument : fields.entries("Arguments")) {
      Fields argument_fields(argument, "an argument of " + fields.what(), source);
      const std::string name = argument_fields.required_name("Name");
      operation.arguments.push_back(
          {name, read_type(argument_fields, model, source), argument_fields.text("Doc")});
    }
    fields.finish();
    if (!operation.name.empty()) model.operations.push_back(std::move(operation));
  }
}

void read_task(const std::string& name, const Value& value, ComponentCatalog& catalog, const Source& source) {
  Fields task(value, "component " + quote(name), source);
  check_name(name, task.what(), value, source);
  ComponentModel model;
  model.name = ComponentName(name);
  model.where = source.at(value);
  read_ports(task, "inputPorts", Direction::Input, model, source);
  read_ports(task, "outputPorts", Direction::Output, model, source);
  read_families(task, "dynamicInputPorts", Direction::Input, model, source);
  read_families(task, "dynamicOutputPorts", Direction::Output, model, source);
  read_properties(task, model, source);
  read_operations(task, model, source);
  task.finish();
  catalog.add(std::move(model));
}

bool is_task(const Value& value) {
  return value.find("inputPorts") != nullptr || value.find("outputPorts") != nullptr;
}

}  // namespace

bool is_rock_export(const Value& root) {
  if (!root.is_map() || root.as_map().empty()) return false;
  return std::ranges::all_of(root.as_map(), [](const auto& project) {
    return project.second.is_map() && !project.second.as_map().empty() &&
           std::ranges::all_of(project.second.as_map(),
                               [](const auto& task) { return is_task(task.second); });
  });
}

void read_rock_export(const Value& root, ComponentCatalog& catalog, const Source& source) {
  for (const auto& [project, tasks] : root.as_map()) {
    const std::string prefix = project + "::";
    for (const auto& [task, value] : tasks.as_map())
      read_task(prefix + task, value, catalog, source);
  }
}

}  // namespace segue::model::detail

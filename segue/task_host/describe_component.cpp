// SPDX-License-Identifier: Apache-2.0
#include <segue/task_host/describe_component.hpp>

#include <segue/base/text.hpp>
#include <segue/model/files.hpp>
#include <segue/task/held_ports.hpp>
#include <segue/task_host/component_library.hpp>
#include <segue/type/type_info.hpp>

#include <set>

namespace segue::task_host {

namespace {

template <class Port>
model::PortModel port_model(const Port& port, model::Direction direction) {
  model::PortModel model;
  model.name = port.name();
  model.direction = direction;
  model.type = port.type_name();
  model.dynamic = port.dynamic();
  model.doc = port.doc();
  return model;
}

model::PortModel family_model(const task::PortFamily& family) {
  model::PortModel model;
  model.name = family.pattern;
  model.direction =
      family.direction == task::Direction::Input ? model::Direction::Input : model::Direction::Output;
  if (family.type != nullptr) model.type = family.type->name();
  model.dynamic = true;
  model.pattern = true;
  model.doc = family.doc;
  return model;
}

void add_ports(const task::Component& component, model::ComponentModel& model) {
  {
    const task::HeldPorts ports(component);
    for (const auto* port : ports.inputs(component)) {
      model.ports.push_back(port_model(*port, model::Direction::Input));
    }
    for (const auto* port : ports.outputs(component)) {
      model.ports.push_back(port_model(*port, model::Direction::Output));
    }
  }
  for (const auto& family : component.port_families()) {
    model.ports.push_back(family_model(family));
  }
}

model::PropertyModel property_model(const task::PropertyBase& property) {
  return {property.name(), property.type_name(), property.default_value(), property.live(), property.doc()};
}

model::OperationModel operation_model(const task::OperationBase& operation) {
  const task::OperationInfo& info = operation.info();
  model::OperationModel model;
  model.name = info.name;
  for (const auto& argument : info.arguments) {
    model.arguments.push_back({argument.name, argument.type_name, {}});
  }
  model.result = info.result;
  model.caller_thread = info.runs_in == task::RunsIn::CallerThread;
  model.doc = info.doc;
  return model;
}

}  // namespace

model::ComponentModel describe(const task::Component& component) {
  model::ComponentModel model;
  model.name = model::ComponentName(component.component_name());
  model.doc = component.options().doc;
  add_ports(component, model);
  for (const auto* property : component.properties()) {
    model.properties.push_back(property_model(*property));
  }
  for (const auto* operation : component.operations()) {
    model.operations.push_back(operation_model(*operation));
  }
  model.activity = component.options().activity;
  model.trigger_ports = component.options().trigger_on;
  model.descriptors = component.options().descriptors;
  model.nominal_states = component.nominal_states();
  model.error_states = component.error_states();
  model.exclusive = component.options().claims;
  return model;
}

namespace detail {

namespace {

std::vector<const type::Type*> parts_of(const type::Type& type) {
  std::vector<const type::Type*> parts;
  for (const auto& field : type.fields) {
    parts.push_back(field.type);
  }
  parts.push_back(type.element);
  return parts;
}

/// Visits the parts of a type before the type, each once. A described C++ type contains itself only through
/// containers.
void collect(const type::Type& type, std::set<const type::Type*>& seen,
             std::vector<const type::Type*>& order) {
  if (!seen.insert(&type).second) {
    return;
  }
  for (const type::Type* part : parts_of(type)) {
    if (part != nullptr) {
      collect(*part, seen, order);
    }
  }
  order.push_back(&type);
}

/// A copy of the type that is composed of the registry's types: each type that `type` refers to is replaced
/// by the registry's type of the same name.
Result<type::Type> copy_into(const type::Type& type, type::TypeRegistry& types) {
  type::Type copy = type;
  std::vector<const type::Type**> parts{&copy.element};
  for (auto& field : copy.fields) {
    parts.push_back(&field.type);
  }
  for (const type::Type** part : parts) {
    const type::Type* own = *part == nullptr ? nullptr : types.find((*part)->name);
    if (*part != nullptr && own == nullptr) {
      return fail(ErrorCode::Unsupported, "type " + quote(type.name) + " holds itself through " +
                                              quote((*part)->name) + "; such types cannot be exported");
    }
    *part = own;
  }
  return copy;
}

Result<void> add_named(std::string_view name, type::TypeRegistry& types) {
  const type::TypeInfo* info = name.empty() ? nullptr : type::find_type_info(name);
  return info == nullptr ? Result<void>{} : add_type(*info->type, types);
}

}  // namespace

Result<void> add_type(const type::Type& type, type::TypeRegistry& types) {
  std::set<const type::Type*> seen;
  std::vector<const type::Type*> order;
  collect(type, seen, order);
  for (const type::Type* part : order) {
    auto copied = copy_into(*part, types);
    if (!copied) {
      return std::move(copied.error());
    }
    if (auto added = types.add(std::move(*copied)); !added) {
      return std::move(added.error());
    }
  }
  return {};
}

Result<void> add_types(const task::Component& component, type::TypeRegistry& types) {
  std::set<std::string> names;
  for (const auto& port : describe(component).ports)
    names.insert(port.type);
  for (const auto* property : component.properties())
    names.insert(property->type_name());
  for (const auto* operation : component.operations()) {
    names.insert(operation->info().result);
    for (const auto& argument : operation->info().arguments)
      names.insert(argument.type_name);
  }
  for (const auto& name : names) {
    if (auto added = add_named(name, types); !added) {
      return added;
    }
  }
  return {};
}

}  // namespace detail

Result<std::string> write_library_models(const LibrarySet& libraries, std::string_view library) {
  model::ComponentCatalog catalog;
  auto models = libraries.export_models(library, catalog.types());
  if (!models) {
    return std::move(models.error());
  }
  std::vector<model::ComponentName> names;
  for (auto& model : *models) {
    names.push_back(model.name);
    catalog.add(std::move(model));
  }
  return model::write_components(catalog, names);
}

}  // namespace segue::task_host

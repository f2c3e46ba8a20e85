// SPDX-License-Identifier: Apache-2.0
#include <segue/model/component_parts.hpp>
#include <segue/model/file_parts.hpp>
#include <segue/model/files.hpp>
#include <segue/type/typelib.hpp>
#include <segue/type/yaml.hpp>

#include <algorithm>
#include <unordered_set>
#include <utility>

namespace segue::model {

using detail::Source;
using detail::text_list;
using type::Value;
using type::ValueMap;

namespace {

bool is_xml(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  const auto first = text.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && text[first] == '<';
}

void read_registry(std::string_view text, ComponentCatalog& catalog, const Source& source) {
  const auto registry = type::read_typelib(text, source.file(), source.diagnostics());
  if (!registry) return;
  if (auto merged = catalog.types().merge(*registry); !merged) {
    source.diagnostics().error("type-conflict", merged.error().message, {source.file(), 0, 0});
  }
}

void append_text(ValueMap& map, std::string_view key, const std::string& text) {
  if (!text.empty()) map.append(std::string(key), text);
}

void append_flag(ValueMap& map, std::string_view key, bool flag) {
  if (flag) map.append(std::string(key), true);
}

void append_texts(ValueMap& map, std::string_view key, const std::vector<std::string>& texts) {
  if (!texts.empty()) map.append(std::string(key), text_list(texts));
}

template <class Items, class Write>
void append_all(ValueMap& map, std::string_view key, const Items& items, Write write) {
  if (items.empty()) return;
  Value::List list;
  for (const auto& item : items)
    list.push_back(write(item));
  map.append(std::string(key), std::move(list));
}

Value write_port(const PortModel& port) {
  ValueMap map;
  map.append(port.pattern ? "pattern" : "name", port.name);
  map.append("direction", to_string(port.direction));
  append_text(map, "type", port.type);
  append_flag(map, "dynamic", port.dynamic && !port.pattern);
  append_text(map, "doc", port.doc);
  return map;
}

Value write_property(const PropertyModel& property) {
  ValueMap map;
  map.append("name", property.name);
  append_text(map, "type", property.type);
  if (!property.default_value.is_null()) map.append("default", property.default_value);
  append_flag(map, "live", property.live);
  append_text(map, "doc", property.doc);
  return map;
}

Value write_argument(const ArgumentModel& argument) {
  ValueMap map;
  map.append("name", argument.name);
  append_text(map, "type", argument.type);
  append_text(map, "doc", argument.doc);
  return map;
}

Value write_operation(const OperationModel& operation) {
  ValueMap map;
  map.append("name", operation.name);
  append_all(map, "arguments", operation.arguments, write_argument);
  append_text(map, "result", operation.result);
  append_flag(map, "caller_thread", operation.caller_thread);
  append_text(map, "doc", operation.doc);
  return map;
}

/// The known types that the models use.
std::vector<const type::Type*> used_types(const ComponentCatalog& catalog,
                                          const std::vector<const ComponentModel*>& models) {
  std::vector<const type::Type*> types;
  std::unordered_set<const type::Type*> seen;
  auto use = [&](const std::string& name) {
    const type::Type* type = name.empty() ? nullptr : catalog.types().find(name);
    if (type != nullptr && seen.insert(type).second) types.push_back(type);
  };
  for (const ComponentModel* model : models) {
    for (const PortModel& port : model->ports)
      use(port.type);
    for (const PropertyModel& property : model->properties)
      use(property.type);
    for (const OperationModel& operation : model->operations) {
      use(operation.result);
      for (const ArgumentModel& argument : operation.arguments)
        use(argument.type);
    }
  }
  return types;
}

}  // namespace

Value to_value(const ComponentModel& model) {
  ValueMap map;
  append_text(map, "doc", model.doc);
  append_text(map, "library", model.library);
  append_text(map, "parent", model.parent);
  append_flag(map, "abstract", model.abstract);
  append_all(map, "ports", model.ports, write_port);
  append_all(map, "properties", model.properties, write_property);
  append_all(map, "operations", model.operations, write_operation);
  if (model.own_activity || !(model.activity == Activity{})) {
    map.append("activity", detail::write_activity(model.activity));
  }
  append_texts(map, "trigger_ports", model.trigger_ports);
  append_texts(map, "descriptors", model.descriptors);
  append_texts(map, "nominal_states", model.nominal_states);
  append_texts(map, "error_states", model.error_states);
  append_texts(map, "exclusive", model.exclusive);
  append_flag(map, "incomplete", model.incomplete);
  return map;
}

std::string write_components(const ComponentCatalog& catalog, const std::vector<ComponentName>& names) {
  std::vector<const ComponentModel*> models;
  ValueMap components;
  for (const ComponentName& name : names) {
    const ComponentModel* model = catalog.find(name);
    if (model == nullptr || std::ranges::find(models, model) != models.end()) continue;
    models.push_back(model);
    components.append(name.str(), to_value(*model));
  }
  ValueMap root;
  root.append("components", std::move(components));
  Value types = detail::write_types(used_types(catalog, models));
  if (!types.as_map().empty()) root.append("types", std::move(types));
  return type::to_yaml(Value(std::move(root)));
}

bool read_components(std::string_view text, const std::string& file, ComponentCatalog& catalog,
                     Diagnostics& diagnostics) {
  const Source source(file, diagnostics);
  const std::size_t errors_before = diagnostics.error_count();
  if (detail::is_orogen(file)) {
    detail::read_orogen(text, catalog, source.foreign());
  } else if (is_xml(text)) {
    read_registry(text, catalog, source);
  } else if (const auto root = source.parse(text)) {
    if (detail::is_rock_interface(*root)) {
      detail::read_rock_interface(*root, catalog, source.foreign());
    } else if (detail::is_rock_export(*root)) {
      detail::read_rock_export(*root, catalog, source.foreign());
    } else {
      detail::read_own_components(*root, catalog, source);
    }
  }
  catalog.register_composite_types();
  return diagnostics.error_count() == errors_before;
}

bool load_components(const std::filesystem::path& file, ComponentCatalog& catalog, Diagnostics& diagnostics) {
  const auto text = detail::read_text(file, diagnostics);
  return text ? read_components(*text, file.string(), catalog, diagnostics) : false;
}

}  // namespace segue::model

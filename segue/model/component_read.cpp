// SPDX-License-Identifier: Apache-2.0
#include <segue/model/component_parts.hpp>
#include <segue/model/file_parts.hpp>
#include <segue/model/port_pattern.hpp>

#include <algorithm>
#include <unordered_set>
#include <utility>

namespace segue::model::detail {

using type::Value;

namespace {

constexpr std::array<std::string_view, 2> kDirectionNames = {"input", "output"};

std::string read_type(Fields& fields, std::string_view key, const Source& source) {
  const std::string written = fields.text(key);
  if (written.empty()) return {};
  auto name = type::canonical_type_name(written);
  if (name) return *name;
  source.error("bad-type", fields.what() + ": " + name.error().message, *fields.find(key));
  return {};
}

template <class Item, class Read>
std::vector<Item> read_list(Fields& fields, std::string_view key, const Source& source, Read read) {
  std::vector<Item> items;
  const Value* list = fields.find(key, Value::Kind::List);
  if (list == nullptr) return items;
  for (const Value& value : list->as_list()) {
    Fields entry(value, "an entry of '" + std::string(key) + "' of " + fields.what(), source);
    items.push_back(read(entry));
    entry.finish();
  }
  return items;
}

PortModel read_port(Fields& fields, const Source& source) {
  PortModel port;
  port.pattern = fields.find("pattern") != nullptr;
  port.name = port.pattern ? fields.text("pattern") : fields.required_name("name", "or give a 'pattern'");
  if (port.pattern) {
    fields.ignore("name");
    if (auto usable = check_port_pattern(port.name); !usable) {
      source.error("bad-pattern", fields.what() + ": " + usable.error().message, *fields.find("pattern"));
    }
  }
  fields.require("direction", "input or output");
  if (auto direction = fields.choice("direction", kDirectionNames, "bad-direction")) {
    port.direction = static_cast<Direction>(*direction);
  }
  port.type = read_type(fields, "type", source);
  port.dynamic = fields.boolean("dynamic", port.pattern) || port.pattern;
  port.doc = fields.text("doc");
  return port;
}

PropertyModel read_property(Fields& fields, const Source& source) {
  PropertyModel property;
  property.name = fields.required_name("name");
  property.type = read_type(fields, "type", source);
  if (const Value* value = fields.find("default")) property.default_value = *value;
  property.live = fields.boolean("live", false);
  property.doc = fields.text("doc");
  return property;
}

OperationModel read_operation(Fields& fields, const Source& source) {
  OperationModel operation;
  operation.name = fields.required_name("name");
  operation.arguments = read_list<ArgumentModel>(fields, "arguments", source, [&](Fields& entry) {
    return ArgumentModel{entry.required_name("name"), read_type(entry, "type", source), entry.text("doc")};
  });
  operation.result = read_type(fields, "result", source);
  operation.caller_thread = fields.boolean("caller_thread", false);
  operation.doc = fields.text("doc");
  return operation;
}

template <class Items, class Key>
void refuse_duplicates(const Items& items, std::string_view kind, const Fields& fields, const Source& source,
                       Key key) {
  std::unordered_set<std::string> seen;
  for (const auto& item : items) {
    if (seen.insert(key(item)).second) continue;
    source.error("duplicate-name",
                 fields.what() + " has two " + std::string(kind) + " named " + quote(item.name),
                 fields.value());
  }
}

void read_component(const std::string& name, Fields& fields, ComponentCatalog& catalog,
                    const Source& source) {
  ComponentModel model;
  check_name(name, fields.what(), fields.value(), source);
  model.name = ComponentName(name);
  model.where = source.at(fields.value());
  model.doc = fields.text("doc");
  model.library = fields.name("library");
  model.parent = fields.name("parent");
  model.abstract = fields.boolean("abstract", false);
  model.ports =
      read_list<PortModel>(fields, "ports", source, [&](Fields& entry) { return read_port(entry, source); });
  model.properties = read_list<PropertyModel>(fields, "properties", source,
                                              [&](Fields& entry) { return read_property(entry, source); });
  model.operations = read_list<OperationModel>(fields, "operations", source,
                                               [&](Fields& entry) { return read_operation(entry, source); });
  if (const Value* activity = fields.find("activity")) {
    model.own_activity = true;
    model.activity = read_activity(*activity, fields.what(), source).value_or(Activity{});
  }
  model.trigger_ports = fields.texts("trigger_ports");
  model.descriptors = fields.texts("descriptors");
  model.nominal_states = fields.texts("nominal_states");
  model.error_states = fields.texts("error_states");
  model.exclusive = fields.texts("exclusive");
  model.incomplete = fields.boolean("incomplete", false);
  refuse_duplicates(model.ports, "ports", fields, source, [](const PortModel& port) {
    return port.name + '\n' + std::string(to_string(port.direction)) + (port.pattern ? port.type : "");
  });
  auto by_name = [](const auto& item) { return item.name; };
  refuse_duplicates(model.properties, "properties", fields, source, by_name);
  refuse_duplicates(model.operations, "operations", fields, source, by_name);
  catalog.add(std::move(model));
}

}  // namespace

void read_own_components(const Value& root, ComponentCatalog& catalog, const Source& source) {
  if (const Value* types = root.find("types"); types != nullptr && !types->is_null()) {
    read_types(*types, catalog.types(), source);
  }
  if (root.find("component") != nullptr) {
    Fields fields(root, "the component", source);
    fields.ignore("types");
    const std::string name = fields.required_name("component");
    if (!name.empty()) read_component(name, fields, catalog, source);
    fields.finish();
    return;
  }
  Fields file(root, "the file", source);
  file.ignore("types");
  const bool only_types = root.find("types") != nullptr && root.find("components") == nullptr;
  const Value* components =
      only_types ? nullptr : file.require("components", "a component model file holds them");
  file.finish();
  if (components == nullptr) return;
  if (!components->is_map()) {
    source.error("wrong-kind", "'components' must be a map, got " + type::describe(*components), *components);
    return;
  }
  for (const auto& [name, value] : components->as_map()) {
    Fields fields(value, "component " + quote(name), source);
    read_component(name, fields, catalog, source);
    fields.finish();
  }
}

}  // namespace segue::model::detail

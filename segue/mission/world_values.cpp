// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/mission_index.hpp>
#include <segue/mission/pool_call.hpp>
#include <segue/mission/world_values.hpp>

#include <algorithm>
#include <charconv>
#include <optional>
#include <set>

namespace segue::mission {

using type::Value;
using type::ValueMap;

namespace {

constexpr std::string_view kWorld = "world.";

/// The first part of a path, which is taken off.
std::string_view take_part(std::string_view& path) {
  const std::size_t end = std::min(path.find('.'), path.size());
  const std::string_view part = path.substr(0, end);
  path.remove_prefix(std::min(end + 1, path.size()));
  return part;
}

std::optional<std::size_t> position_in(const Value::List& list, std::string_view part) {
  std::size_t position = 0;
  const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), position);
  if (error != std::errc() || end != part.data() + part.size() || position >= list.size())
    return std::nullopt;
  return position;
}

/// The value with `item` as its field. A field that a map lacks is added; what is neither a map nor a list
/// that is long enough becomes a map.
Value with_field(Value value, std::string_view path, Value item) {
  if (path.empty()) return item;
  const std::string_view part = take_part(path);
  if (value.is_list()) {
    if (const auto at = position_in(value.as_list(), part)) {
      Value::List list = value.as_list();
      list[*at] = with_field(std::move(list[*at]), path, std::move(item));
      return list;
    }
  }
  ValueMap map = value.is_map() ? value.as_map() : ValueMap();
  const Value* old = map.find(part);
  map.set(std::string(part), with_field(old == nullptr ? Value() : *old, path, std::move(item)));
  return map;
}

/// The path with values of ports in place of "{port}".
std::string filled_path(std::string_view path, const std::function<const Value&(std::string_view)>& port) {
  std::string text(path);
  for (const std::string& name : placeholders(path)) {
    const std::string placeholder = "{" + name + "}";
    const Value& value = port(name);
    text.replace(text.find(placeholder), placeholder.size(),
                 value.is_string() ? value.as_string() : type::describe(value));
  }
  return text;
}

template <class Visit>
void visit_values(const Action& action, const Visit& visit) {
  if (const auto* call = std::get_if<PoolCall>(&action.run)) visit(call->arguments);
  if (const auto* use = std::get_if<ControllerUse>(&action.run)) {
    for (const auto* values : {&use->set, &use->call, &use->write}) {
      for (const MemberValue& one : *values)
        visit(one.value);
    }
  }
  for (const DataChange& change : action.changes)
    visit(change.value);
}

bool changes(const DataChange& change, std::string_view data) {
  return world_field(change.field).data == data;
}

}  // namespace

bool is_value(const DeclaredData& data) {
  return data.functions.file.empty() && data.functions.text.empty();
}

WorldValues initial_values(const Mission& mission) {
  WorldValues values;
  for (const DeclaredData& data : mission.world_data) {
    if (is_value(data)) values.emplace(data.name, data.initial);
  }
  return values;
}

WorldField world_field(std::string_view text) {
  const std::string_view data = take_part(text);
  return {data, text};
}

std::optional<WorldField> placeholder_field(std::string_view placeholder) {
  if (!placeholder.starts_with(kWorld)) return std::nullopt;
  return world_field(placeholder.substr(kWorld.size()));
}

Value value_of(const Value& data, std::string_view placeholder) {
  const Value* part = &data;
  std::string_view path = placeholder_field(placeholder)->path;
  while (part != nullptr && !path.empty()) {
    const std::string_view name = take_part(path);
    if (part->is_list()) {
      const auto at = position_in(part->as_list(), name);
      part = at ? &part->as_list()[*at] : nullptr;
    } else {
      part = part->is_map() ? part->find(name) : nullptr;
    }
  }
  return part == nullptr ? Value() : *part;
}

std::vector<std::string> world_placeholders(const Action& action) {
  std::vector<std::string> names;
  visit_values(action, [&](const Value& value) {
    for (std::string& name : inputs_named_in(value)) {
      const bool known = std::ranges::find(names, name) != names.end();
      if (!known && placeholder_field(name) && !position(action.inputs, name))
        names.push_back(std::move(name));
    }
  });
  return names;
}

std::vector<std::string> values_read(const Mission& mission, const Action& action) {
  std::set<std::string> names(action.reads_data.begin(), action.reads_data.end());
  for (const std::string& placeholder : world_placeholders(action))
    names.emplace(placeholder_field(placeholder)->data);
  if (action.reads_world) {
    for (const auto& [name, value] : initial_values(mission))
      names.insert(name);
  }
  return {names.begin(), names.end()};
}

std::vector<std::string> values_changed(const Action& action) {
  std::set<std::string> names;
  for (const DataChange& change : action.changes)
    names.emplace(world_field(change.field).data);
  return {names.begin(), names.end()};
}

std::vector<std::string> values_touched(const Action& action) {
  const auto changed = values_changed(action);
  std::set<std::string> names(changed.begin(), changed.end());
  for (const Port& port : action.inputs) {
    if (port.from_world) names.emplace(placeholder_field(port.name)->data);
  }
  return {names.begin(), names.end()};
}

void add_world_inputs(Mission& mission) {
  for (Action& action : mission.actions) {
    std::vector<std::string> names = world_placeholders(action);
    std::vector<std::string> looked_at = action.reads_data;
    if (action.reads_world) looked_at = values_read(mission, action);
    for (const std::string& data : looked_at) {
      std::string name = std::string(kWorld) + data;
      if (std::ranges::find(names, name) == names.end()) names.push_back(std::move(name));
    }
    for (std::string& name : names) {
      Port port;
      port.name = std::move(name);
      port.where = action.where;
      port.from_world = true;
      action.inputs.push_back(std::move(port));
    }
  }
}

std::vector<std::string> sources_of(const DataChange& change) {
  std::vector<std::string> names = placeholders(change.field);
  for (std::string& name : inputs_named_in(change.value))
    names.push_back(std::move(name));
  return names;
}

std::vector<std::string> sources_of_change(const Action& action, std::string_view data) {
  std::vector<std::string> names;
  for (const DataChange& change : action.changes) {
    if (!changes(change, data)) continue;
    for (std::string& name : sources_of(change)) {
      if (std::ranges::find(names, name) == names.end()) names.push_back(std::move(name));
    }
  }
  return names;
}

Value changed_value(const Action& action, std::string_view data, Value value,
                    const std::function<const Value&(std::string_view)>& port) {
  for (const DataChange& change : action.changes) {
    if (!changes(change, data)) continue;
    const std::string path = filled_path(world_field(change.field).path, port);
    value = with_field(std::move(value), path, filled(change.value, port));
  }
  return value;
}

}  // namespace segue::mission

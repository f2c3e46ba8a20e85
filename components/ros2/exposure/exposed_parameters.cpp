// SPDX-License-Identifier: Apache-2.0
#include "exposed_parameters.hpp"

#include <segue/ros2/parameter_value.hpp>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <set>
#include <utility>

namespace ros2 {

using segue::type::Value;
using segue::type::ValueMap;

namespace {

/// A list without items does not show its kind, but its type does: "/std/vector</double>".
std::optional<Value> empty_list(std::string_view type) {
  constexpr std::string_view kVector = "/std/vector<";
  Value item = "";  // as a list whose type is not known
  if (type.starts_with(kVector)) {
    const std::string_view of = type.substr(kVector.size(), type.size() - kVector.size() - 1);
    const bool is_integer = of.starts_with("/int") || of.starts_with("/uint");
    if (of == "/bool")
      item = true;
    else if (of == "/double" || of == "/float")
      item = 0.0;
    else if (is_integer && of.ends_with("_t"))
      item = 0;
    else if (of != "/std/string")
      return {};
  }
  auto message = segue::ros2::parameter_value(Value::list({item}));
  for (auto& [key, part] : message->as_map()) {
    if (part.is_list()) part = Value::List();
  }
  return message;
}

/// "in milliseconds" for "/std/chrono/milliseconds".
std::string unit_of(const std::string& type) {
  constexpr std::string_view kDuration = "/std/chrono/";
  const bool has_name = type.starts_with(kDuration) && type.find('<') == std::string::npos;
  return has_name ? "in " + type.substr(kDuration.size()) : std::string();
}

struct PropertyFacts {
  std::string type{};
  std::string doc{};
  bool is_live = false;
};

void append_parameter(std::vector<ExposedParameter>& all, const std::string& name, const Value& value,
                      const PropertyFacts& facts) {
  if (value.is_map()) {
    for (const auto& [key, part] : value.as_map())
      append_parameter(all, name + "." + key, part, {{}, facts.doc, facts.is_live});
    return;
  }
  const bool is_empty = value.is_list() && value.as_list().empty();
  auto message = is_empty ? empty_list(facts.type) : segue::ros2::parameter_value(value);
  if (message) all.push_back({name, std::move(*message), facts.doc, unit_of(facts.type), facts.is_live});
}

PropertyFacts facts_of(const Value& task, const std::string& property) {
  const Value* models = task.find("property_models");
  if (models == nullptr || !models->is_list()) return {};
  for (const Value& one : models->as_list()) {
    if (*one.find("name") == Value(property))
      return {one.find("type")->as_string(), one.find("doc")->as_string(), one.find("live")->as_bool()};
  }
  return {};
}

/// One item for each name that the request has, in its order.
template <class Of>
Value for_names(const Value& request, const char* field, Of of) {
  Value::List all;
  for (const Value& name : request.find("names")->as_list())
    all.push_back(of(name.as_string()));
  return Value::map({{field, Value(std::move(all))}});
}

std::uint64_t separators_in(std::string_view name) {
  return static_cast<std::uint64_t>(std::ranges::count(name, '.'));
}

/// Whether a parameter is below the prefix, and not deeper than that (0: any depth), as in rclcpp.
bool is_below(std::string_view name, std::string_view prefix, std::uint64_t depth) {
  if (name == prefix) return true;
  if (!name.starts_with(prefix) || name.size() <= prefix.size() || name[prefix.size()] != '.') return false;
  return depth == 0 || separators_in(name.substr(prefix.size() + 1)) < depth;
}

bool is_listed(std::string_view name, const Value::List& prefixes, std::uint64_t depth) {
  if (prefixes.empty()) return depth == 0 || separators_in(name) < depth;
  return std::ranges::any_of(prefixes,
                             [&](const Value& prefix) { return is_below(name, prefix.as_string(), depth); });
}

std::uint64_t depth_of(const Value& request) {
  const Value& depth = *request.find("depth");
  return depth.kind() == Value::Kind::UInt ? depth.as_uint() : static_cast<std::uint64_t>(depth.as_int());
}

/// As rcl_interfaces/msg/Parameter.
Value parameter_message(const ExposedParameter& parameter) {
  return Value::map({{"name", parameter.name}, {"value", parameter.value}});
}

}  // namespace

std::vector<ExposedParameter> parameters_of(const Value& task) {
  std::vector<ExposedParameter> all;
  const Value* properties = task.find("properties");
  if (properties == nullptr || !properties->is_map()) return all;
  for (const auto& [name, value] : properties->as_map())
    append_parameter(all, name, value, facts_of(task, name));
  return all;
}

const ExposedParameter* find_parameter(const std::vector<ExposedParameter>& all, std::string_view name) {
  const auto found = std::ranges::find(all, name, &ExposedParameter::name);
  return found == all.end() ? nullptr : &*found;
}

Value list_parameters(const std::vector<ExposedParameter>& all, const Value& request) {
  Value::List names;
  std::set<std::string> prefixes;
  for (const ExposedParameter& one : all) {
    if (!is_listed(one.name, request.find("prefixes")->as_list(), depth_of(request))) continue;
    names.emplace_back(one.name);
    if (const auto dot = one.name.rfind('.'); dot != std::string::npos)
      prefixes.insert(one.name.substr(0, dot));
  }
  return Value::map({{"result", Value::map({{"names", Value(std::move(names))},
                                            {"prefixes", Value::List(prefixes.begin(), prefixes.end())}})}});
}

Value get_parameters(const std::vector<ExposedParameter>& all, const Value& request) {
  return for_names(request, "values", [&](const std::string& name) {
    const auto* found = find_parameter(all, name);
    return found == nullptr ? Value::map({{"type", 0}}) : found->value;
  });
}

Value get_parameter_types(const std::vector<ExposedParameter>& all, const Value& request) {
  return for_names(request, "types", [&](const std::string& name) {
    const auto* found = find_parameter(all, name);
    return found == nullptr ? Value(0) : *found->value.find("type");
  });
}

Value describe_parameters(const std::vector<ExposedParameter>& all, const Value& request, bool writable) {
  return for_names(request, "descriptors", [&](const std::string& name) {
    const auto* found = find_parameter(all, name);
    if (found == nullptr) return Value::map({{"name", name}, {"type", 0}});
    return Value::map({{"name", name},
                       {"type", *found->value.find("type")},
                       {"description", found->doc},
                       {"additional_constraints", found->constraints},
                       {"read_only", !writable || !found->is_live}});
  });
}

std::optional<Value> parameter_event(const std::vector<ExposedParameter>& before,
                                     const std::vector<ExposedParameter>& now) {
  Value::List added;
  Value::List changed;
  Value::List deleted;
  for (const ExposedParameter& one : now) {
    const ExposedParameter* was = find_parameter(before, one.name);
    if (was == nullptr)
      added.push_back(parameter_message(one));
    else if (was->value != one.value)
      changed.push_back(parameter_message(one));
  }
  for (const ExposedParameter& one : before) {
    if (find_parameter(now, one.name) == nullptr) deleted.push_back(parameter_message(one));
  }
  if (added.empty() && changed.empty() && deleted.empty()) return {};
  return Value::map({{"new_parameters", Value(std::move(added))},
                     {"changed_parameters", Value(std::move(changed))},
                     {"deleted_parameters", Value(std::move(deleted))}});
}

}  // namespace ros2

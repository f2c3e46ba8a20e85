// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/parameter_value.hpp>

#include <segue/base/text.hpp>

#include <segue/type/json.hpp>

#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

namespace segue::ros2 {
namespace {

using type::Value;

/// A kind of parameter: its number in rcl_interfaces/msg/ParameterType, and its field in ParameterValue.
struct ParameterKind {
  int number;
  const char* field;
};

std::optional<ParameterKind> scalar_kind(const Value& value) {
  switch (value.kind()) {
    case Value::Kind::Bool:
      return ParameterKind{1, "bool_value"};
    case Value::Kind::Int:
      return ParameterKind{2, "integer_value"};
    case Value::Kind::Float:
      return ParameterKind{3, "double_value"};
    case Value::Kind::String:
      return ParameterKind{4, "string_value"};
    default:
      return {};
  }
}

/// Of a list by its items; that of an empty one is not known, and is taken for texts.
std::optional<ParameterKind> list_kind(const Value::List& items) {
  constexpr std::array<ParameterKind, 4> kLists = {{{6, "bool_array_value"},
                                                    {7, "integer_array_value"},
                                                    {8, "double_array_value"},
                                                    {9, "string_array_value"}}};
  if (items.empty()) return kLists.back();
  const auto first = scalar_kind(items.front());
  if (!first) return {};
  for (const Value& item : items) {
    const auto kind = scalar_kind(item);
    if (!kind || kind->number != first->number) return {};
  }
  return kLists.at(static_cast<std::size_t>(first->number - 1));
}

Result<void> append(Value::List& parameters, const Value& value, const std::string& name,
                    std::string_view path) {
  if (value.is_map()) {
    for (const auto& [key, part] : value.as_map()) {
      if (auto done = append(parameters, part, name.empty() ? key : name + "." + key, path); !done)
        return done;
    }
    return {};
  }
  auto message = parameter_value(value);
  if (!message || name.empty()) {
    return fail(
        ErrorCode::InvalidArgument,
        std::string(path) + (name.empty() ? "" : "." + name) + ": expected " +
            (name.empty() ? "a map of parameters" : "a bool, a number, a text, or a list of one of these"));
  }
  parameters.push_back(Value::map({{"name", name}, {"value", std::move(*message)}}));
  return {};
}

/// With a point or an exponent, by which it is a double.
std::string yaml_number(double number) {
  if (std::isnan(number)) return ".nan";
  if (std::isinf(number)) return number > 0 ? ".inf" : "-.inf";
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
  std::string text(digits.data(), end);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

/// As ROS 2's reader of YAML 1.1 takes it, to which yes, 1e3 and 010 mean other things than here.
std::string yaml_text(const Value& value) {
  switch (value.kind()) {
    case Value::Kind::Map: {
      std::string text;
      for (const auto& [key, part] : value.as_map())
        text += (text.empty() ? "" : ", ") + type::to_json(Value(key), 0) + ": " + yaml_text(part);
      return "{" + text + "}";
    }
    case Value::Kind::List: {
      std::string text;
      for (const Value& item : value.as_list())
        text += (text.empty() ? "" : ", ") + yaml_text(item);
      return "[" + text + "]";
    }
    case Value::Kind::Float:
      return yaml_number(value.as_double());
    default:
      return type::to_json(value, 0);
  }
}

}  // namespace

std::string parameter_file(std::string_view node, const Value& parameters) {
  return type::to_json(Value(node), 0) + ": {\"ros__parameters\": " + yaml_text(parameters) + "}\n";
}

std::optional<Value> parameter_value(const Value& value) {
  const auto kind = value.is_list() ? list_kind(value.as_list()) : scalar_kind(value);
  if (!kind) return {};
  return Value::map({{"type", kind->number}, {kind->field, value}});
}

Result<Value> parameters_request(const Value& parameters, std::string_view path) {
  Value::List list;
  if (auto done = append(list, parameters, "", path); !done) return done.error();
  return Value::map({{"parameters", Value(std::move(list))}});
}

Value parameter_from(const Value& message) {
  constexpr std::array<const char*, 10> kFields = {"",
                                                   "bool_value",
                                                   "integer_value",
                                                   "double_value",
                                                   "string_value",
                                                   "byte_array_value",
                                                   "bool_array_value",
                                                   "integer_array_value",
                                                   "double_array_value",
                                                   "string_array_value"};
  const auto number = static_cast<std::size_t>(message.find("type")->as_uint());
  return number == 0 || number >= kFields.size() ? Value() : *message.find(kFields[number]);
}

std::string_view parameter_kind(std::int64_t number) {
  constexpr std::array<std::string_view, 10> kNames = {
      "not set",    "boolean",       "integer",       "double",       "string",
      "byte array", "boolean array", "integer array", "double array", "string array"};
  return number < 0 || number >= std::ssize(kNames) ? "unknown" : kNames[static_cast<std::size_t>(number)];
}

}  // namespace segue::ros2

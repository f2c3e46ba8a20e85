// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/interface_definition.hpp>

#include <segue/base/text.hpp>
#include <segue/ros2/interface_names.hpp>

#include <algorithm>
#include <array>
#include <utility>

namespace segue::ros2 {

namespace {

bool is_lower(char c) {
  return c >= 'a' && c <= 'z';
}
bool is_upper(char c) {
  return c >= 'A' && c <= 'Z';
}
bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

constexpr std::array<std::pair<std::string_view, Primitive>, 15> kPrimitives{
    {{"bool", Primitive::Bool},
     {"byte", Primitive::Byte},
     {"char", Primitive::Uint8},
     {"float32", Primitive::Float32},
     {"float64", Primitive::Float64},
     {"int8", Primitive::Int8},
     {"uint8", Primitive::Uint8},
     {"int16", Primitive::Int16},
     {"uint16", Primitive::Uint16},
     {"int32", Primitive::Int32},
     {"uint32", Primitive::Uint32},
     {"int64", Primitive::Int64},
     {"uint64", Primitive::Uint64},
     {"string", Primitive::String},
     {"wstring", Primitive::WString}}};

std::string_view name_of(Primitive primitive) {
  if (primitive == Primitive::Uint8) return "uint8";
  if (primitive == Primitive::BoundedString) return "string";
  if (primitive == Primitive::BoundedWString) return "wstring";
  const auto* const found =
      std::ranges::find(kPrimitives, primitive, [](const auto& one) { return one.second; });
  return found == kPrimitives.end() ? "" : found->first;
}

}  // namespace

bool is_package_name(std::string_view name) {
  return !name.empty() && is_lower(name.front()) && name.back() != '_' &&
         name.find("__") == std::string_view::npos &&
         std::ranges::all_of(name, [](char c) { return is_lower(c) || is_digit(c) || c == '_'; });
}

bool is_message_name(std::string_view name) {
  return !name.empty() && is_upper(name.front()) &&
         std::ranges::all_of(name, [](char c) { return is_upper(c) || is_lower(c) || is_digit(c); });
}

bool is_constant_name(std::string_view name) {
  return !name.empty() && is_upper(name.front()) && name.back() != '_' &&
         name.find("__") == std::string_view::npos &&
         std::ranges::all_of(name, [](char c) { return is_upper(c) || is_digit(c) || c == '_'; });
}

std::optional<Primitive> primitive_named(std::string_view name) {
  const auto* const found = std::ranges::find(kPrimitives, name, [](const auto& one) { return one.first; });
  return found == kPrimitives.end() ? std::nullopt : std::optional(found->second);
}

Result<InterfaceName> parse_interface_name(std::string_view text) {
  const auto parts = split(text, '/');
  InterfaceName name;
  if (parts.size() == 2 || parts.size() == 3) {
    name = {std::string(parts.front()), parts.size() == 3 ? std::string(parts[1]) : "msg",
            std::string(parts.back())};
    const bool is_kind = name.kind == "msg" || name.kind == "srv" || name.kind == "action";
    // Parts of services and actions have a suffix: SetBool_Request.
    const auto words = split(name.name, '_');
    const bool is_name = words.size() <= 3 && std::ranges::all_of(words, is_message_name);
    if (is_package_name(name.package) && is_kind && is_name) return name;
  }
  return fail(
      ErrorCode::InvalidArgument,
      quote(text) + " is not a valid name of an interface of ROS 2, such as sensor_msgs/msg/LaserScan");
}

std::string to_string(const InterfaceName& name) {
  return name.package + "/" + name.kind + "/" + name.name;
}

std::string to_string(const FieldType& type) {
  std::string text = type.primitive == Primitive::Nested ? type.nested : std::string(name_of(type.primitive));
  if (type.string_capacity > 0) text += "<=" + std::to_string(type.string_capacity);
  switch (type.multiplicity) {
    case Multiplicity::Single:
      return text;
    case Multiplicity::Array:
      return text + "[" + std::to_string(type.capacity) + "]";
    case Multiplicity::BoundedSequence:
      return text + "[<=" + std::to_string(type.capacity) + "]";
    case Multiplicity::Sequence:
      return text + "[]";
  }
  return text;
}

}  // namespace segue::ros2

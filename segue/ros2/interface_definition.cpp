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

struct PrimitiveNames {
  Primitive primitive;
  std::string_view in_files;
  std::string_view of_ports;  ///< as of TypeRegistry; empty: there are no such ports
};

/// Of two names in files for the same, the first is written.
constexpr std::array<PrimitiveNames, 17> kPrimitives{{{Primitive::Bool, "bool", "/bool"},
                                                      {Primitive::Byte, "byte", "/uint8_t"},
                                                      {Primitive::Float32, "float32", "/float"},
                                                      {Primitive::Float64, "float64", "/double"},
                                                      {Primitive::Int8, "int8", "/int8_t"},
                                                      {Primitive::Uint8, "uint8", "/uint8_t"},
                                                      {Primitive::Uint8, "char", "/uint8_t"},
                                                      {Primitive::Int16, "int16", "/int16_t"},
                                                      {Primitive::Uint16, "uint16", "/uint16_t"},
                                                      {Primitive::Int32, "int32", "/int32_t"},
                                                      {Primitive::Uint32, "uint32", "/uint32_t"},
                                                      {Primitive::Int64, "int64", "/int64_t"},
                                                      {Primitive::Uint64, "uint64", "/uint64_t"},
                                                      {Primitive::String, "string", "/std/string"},
                                                      {Primitive::WString, "wstring", ""},
                                                      {Primitive::BoundedString, "string", "/std/string"},
                                                      {Primitive::BoundedWString, "wstring", ""}}};

}  // namespace

bool is_package_name(std::string_view name) {
  return !name.empty() && is_lower(name.front()) && name.back() != '_' &&
         name.find("__") == std::string_view::npos &&
         std::ranges::all_of(name, [](char c) { return is_lower(c) || is_digit(c) || c == '_'; });
}

bool is_topic_token(std::string_view name) {
  return !name.empty() && !is_digit(name.front()) && std::ranges::all_of(name, [](char c) {
    return is_upper(c) || is_lower(c) || is_digit(c) || c == '_';
  });
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
  const auto* const found = std::ranges::find(kPrimitives, name, &PrimitiveNames::in_files);
  return found == kPrimitives.end() ? std::nullopt : std::optional(found->primitive);
}

std::string_view port_type(Primitive primitive) {
  const auto* const found = std::ranges::find(kPrimitives, primitive, &PrimitiveNames::primitive);
  return found == kPrimitives.end() ? "" : found->of_ports;
}

std::string_view to_string(Primitive primitive) {
  const auto* const found = std::ranges::find(kPrimitives, primitive, &PrimitiveNames::primitive);
  return found == kPrimitives.end() ? "" : found->in_files;
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
  std::string text =
      type.primitive == Primitive::Nested ? type.nested : std::string(to_string(type.primitive));
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

// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/cpp_header.hpp>

#include <segue/base/text.hpp>
#include <segue/ros2/interface_names.hpp>
#include <segue/ros2/message_type.hpp>
#include <segue/type/json.hpp>

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <cmath>
#include <iterator>
#include <set>

namespace segue::ros2 {

namespace {

using type::Value;

constexpr std::size_t kMostMembers = 64;  ///< of SEGUE_TYPE

/// "laser_scan" of "LaserScan", "set_bool__request" of "SetBool_Request", as rosidl names files.
std::string snake_case(std::string_view name) {
  const auto is_upper = [&](std::size_t i) { return std::isupper(static_cast<unsigned char>(name[i])) != 0; };
  std::string text;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const bool ends_word =
        i > 0 && is_upper(i) &&
        (!is_upper(i - 1) || (i + 1 < name.size() && !is_upper(i + 1) && name[i + 1] != '_'));
    if (ends_word) text += '_';
    text += static_cast<char>(std::tolower(static_cast<unsigned char>(name[i])));
  }
  return text;
}

std::string path_of(std::string_view message) {
  const auto parts = split(message, '/');
  return fmt::format("{}/{}/{}.hpp", parts[0], parts[1], snake_case(parts[2]));
}

/// "geometry_msgs::Point"
std::string qualified(std::string_view message) {
  const auto parts = split(message, '/');
  return fmt::format("{}::{}", parts.front(), parts.back());
}

std::string item_type(const FieldType& type) {
  if (type.primitive == Primitive::Nested) return qualified(type.nested);
  const std::string_view name = port_type(type.primitive).substr(1);
  if (name == "std/string") return "std::string";
  return (name.ends_with("_t") ? "std::" : "") + std::string(name);
}

std::string member_type(const FieldType& type) {
  const std::string item = item_type(type);
  if (type.multiplicity == Multiplicity::Single) return item;
  return type.multiplicity == Multiplicity::Array ? fmt::format("std::array<{}, {}>", item, type.capacity)
                                                  : fmt::format("std::vector<{}>", item);
}

/// The value as C++ writes it.
std::string literal(const Value& value, Primitive primitive) {
  if (value.is_list()) {
    std::string text;
    for (const Value& item : value.as_list())
      text += (text.empty() ? "" : ", ") + literal(item, primitive);
    return text;
  }
  if (value.is_string()) return type::to_json(value);
  if (primitive != Primitive::Float32 && primitive != Primitive::Float64) {
    const bool is_lowest = value == Value(std::int64_t{INT64_MIN});
    return is_lowest ? "INT64_MIN" : type::to_json(value) + (primitive == Primitive::Uint64 ? "U" : "");
  }
  const double number = value.as_double();
  const std::string own = primitive == Primitive::Float32 ? "float" : "double";
  if (std::isnan(number)) return "std::numeric_limits<" + own + ">::quiet_NaN()";
  if (std::isinf(number)) return (number < 0 ? "-" : "") + ("std::numeric_limits<" + own + ">::infinity()");
  return fmt::format("{}{}", number,
                     primitive == Primitive::Float32 && number != std::trunc(number) ? "F" : "");
}

std::string member(const FieldDefinition& field) {
  std::string value;
  if (field.default_value) {
    value = literal(*field.default_value, field.type.primitive);
  } else if (field.type.multiplicity == Multiplicity::Single && field.type.primitive == Primitive::Bool) {
    value = "false";
  } else if (field.type.multiplicity == Multiplicity::Single && item_type(field.type) != "std::string" &&
             field.type.primitive != Primitive::Nested) {
    value = "0";
  }
  return fmt::format("  {} {}{{{}}};\n", member_type(field.type), field.name, value);
}

std::string constant(const ConstantDefinition& one) {
  const std::string item = item_type({.primitive = one.type});
  return fmt::format("  static constexpr {} {} = {};\n", item == "std::string" ? "const char*" : item,
                     one.name, literal(one.value, one.type));
}

std::string header_of(const MessageDefinition& message) {
  std::string text = fmt::format(
      "// {}, made by `segue ros2 headers`.\n#pragma once\n\n#include <segue/type/describe.hpp>\n\n",
      message.name);
  const auto out = std::back_inserter(text);
  std::set<std::string> parts;
  std::string members;
  std::string names;
  for (const FieldDefinition& field : message.fields) {
    if (field.type.primitive == Primitive::Nested) parts.insert(path_of(field.type.nested));
    members += member(field);
    names += ", " + field.name;
  }
  for (const std::string& part : parts)
    fmt::format_to(out, "#include <{}>\n", part);
  if (!parts.empty()) text += '\n';
  for (const char* standard : {"array", "cstdint", "limits", "string", "vector"})
    fmt::format_to(out, "#include <{}>\n", standard);
  std::string constants;
  for (const ConstantDefinition& one : message.constants)
    constants += constant(one);
  const auto name = split(message.name, '/');
  fmt::format_to(out, "\nnamespace {} {{\n\nstruct {} {{\n{}{}}};\nSEGUE_TYPE({}{})\n\n}}  // namespace {}\n",
                 name.front(), name.back(), constants, members, name.back(), names, name.front());
  return text;
}

}  // namespace

Result<std::vector<CppHeader>> cpp_headers(InterfaceLibrary& library, std::string_view name) {
  type::TypeRegistry registry;
  if (auto type = message_type(library, name, registry); !type) return type.error();
  const auto messages = library.with_parts(name);
  if (!messages) return messages.error();
  std::vector<CppHeader> headers;
  for (const MessageDefinition* message : *messages) {
    if (message->fields.size() > kMostMembers)
      return fail(ErrorCode::Unsupported, message->name + " has more than " + std::to_string(kMostMembers) +
                                              " fields, which is the most that SEGUE_TYPE takes");
    headers.push_back({path_of(message->name), header_of(*message)});
  }
  return headers;
}

}  // namespace segue::ros2

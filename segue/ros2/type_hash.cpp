// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/type_hash.hpp>

#include <segue/base/sha256.hpp>

#include <fmt/format.h>

#include <iterator>

namespace segue::ros2 {

namespace {

/// Names are identifiers, so nothing needs an escape.
void append(const MessageDefinition& message, std::string& text) {
  const auto out = std::back_inserter(text);
  fmt::format_to(out, R"({{"type_name": "{}", "fields": [)", message.name);
  std::string_view before;
  for (const FieldDefinition& field : message.fields) {
    const FieldType& type = field.type;
    const int id = static_cast<int>(type.primitive) + static_cast<int>(type.multiplicity);
    fmt::format_to(out,
                   R"({}{{"name": "{}", "type": {{"type_id": {}, "capacity": {}, "string_capacity": {}, )"
                   R"("nested_type_name": "{}"}}}})",
                   before, field.name, id, type.capacity, type.string_capacity, type.nested);
    before = ", ";
  }
  text += "]}";
}

std::string type_description(std::span<const MessageDefinition* const> messages) {
  std::string text = R"({"type_description": )";
  append(*messages.front(), text);
  text += R"(, "referenced_type_descriptions": [)";
  for (std::size_t i = 1; i < messages.size(); ++i) {
    if (i > 1) text += ", ";
    append(*messages[i], text);
  }
  return text + "]}";
}

}  // namespace

Result<std::string> type_description(InterfaceLibrary& library, std::string_view name) {
  const auto messages = library.with_parts(name);
  if (!messages) return messages.error();
  return type_description(*messages);
}

std::string type_hash(std::span<const MessageDefinition* const> messages) {
  return "RIHS01_" + sha256(type_description(messages));
}

Result<std::string> type_hash(InterfaceLibrary& library, std::string_view name) {
  const auto messages = library.with_parts(name);
  if (!messages) return messages.error();
  return type_hash(*messages);
}

}  // namespace segue::ros2

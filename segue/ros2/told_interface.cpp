// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/told_interface.hpp>

#include <segue/base/text.hpp>
#include <segue/ros2/interface_library.hpp>
#include <segue/ros2/interface_names.hpp>
#include <segue/ros2/interface_text.hpp>
#include <segue/ros2/type_hash.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <utility>

namespace segue::ros2 {
namespace {

using type::Value;

/// From type_description_interfaces/msg/FieldType; nothing for kinds that .msg files cannot have.
std::optional<FieldType> field_type(const Value& told) {
  constexpr std::uint64_t kStep = 48;  // between the multiplicities
  const std::uint64_t number = told.find("type_id")->as_uint();
  FieldType type;
  type.primitive = static_cast<Primitive>(number % kStep);
  type.multiplicity = static_cast<Multiplicity>(number - number % kStep);
  type.nested = told.find("nested_type_name")->as_string();
  type.capacity = told.find("capacity")->as_uint();
  type.string_capacity = told.find("string_capacity")->as_uint();
  const bool is_nested = type.primitive == Primitive::Nested;
  const auto nested = parse_interface_name(type.nested);
  if (is_nested ? !nested || nested->kind != "msg" : to_string(type.primitive).empty()) return {};
  return type;
}

Result<MessageDefinition> message_from(const Value& told) {
  MessageDefinition message{told.find("type_name")->as_string()};
  const auto name = parse_interface_name(message.name);
  if (!name || name->kind != "msg" || to_string(*name) != message.name)
    return fail(ErrorCode::InvalidArgument, quote(message.name) + " is not a valid name of a message");
  for (const Value& field : told.find("fields")->as_list()) {
    FieldDefinition made{field.find("name")->as_string(), {}};
    const auto type = field_type(*field.find("type"));
    if (!type || !is_package_name(made.name))
      return fail(ErrorCode::InvalidArgument,
                  "field " + quote(made.name) + " of " + message.name + " is not one of a .msg file");
    made.type = *type;
    message.fields.push_back(std::move(made));
  }
  return message;
}

Result<std::vector<MessageDefinition>> messages_from(const Value& description) {
  std::vector<MessageDefinition> messages;
  Value::List all = description.find("referenced_type_descriptions")->as_list();
  all.insert(all.begin(), *description.find("type_description"));
  for (const Value& one : all) {
    auto message = message_from(one);
    if (!message) return message.error();
    messages.push_back(std::move(*message));
  }
  return messages;
}

bool have_same_fields(const MessageDefinition& one, const MessageDefinition& other) {
  return std::ranges::equal(one.fields, other.fields, [](const auto& a, const auto& b) {
    return a.name == b.name && a.type == b.type;
  });
}

/// The node's own file where it says what the description says.
std::string text_from(const MessageDefinition& message, const Value::List& sources) {
  for (const Value& source : sources) {
    if (source.find("type_name")->as_string() != message.name ||
        source.find("encoding")->as_string() != "msg")
      continue;
    const std::string& text = source.find("raw_file_contents")->as_string();
    Diagnostics ignored;
    const auto read = read_interface(*parse_interface_name(message.name), text, message.name, ignored);
    if (!read.empty() && have_same_fields(read.front(), message)) return text;
  }
  return message_text(message);
}

bool is_built_in(const MessageDefinition& message) {
  InterfaceLibrary library;
  const auto found = library.find(message.name);
  return found && have_same_fields(**found, message);
}

}  // namespace

Result<std::vector<InterfaceFile>> told_interface(const Value& response, std::string_view name,
                                                  std::string_view hash) {
  const auto refused = [&](const std::string& why) {
    return fail(ErrorCode::InvalidArgument, "type " + std::string(name) + ": " + why);
  };
  if (!response.find("successful")->as_bool())
    return refused("the node does not tell it: " + response.find("failure_reason")->as_string());
  const auto messages = messages_from(*response.find("type_description"));
  if (!messages) return refused(messages.error().message);
  std::vector<const MessageDefinition*> all;
  for (const MessageDefinition& message : *messages)
    all.push_back(&message);
  if (const std::string own = type_hash(all); messages->front().name != name || own != hash)
    return refused("what the node tells is another type (" + messages->front().name + ", " + own +
                   ") than it has (" + std::string(hash) + ")");
  std::vector<InterfaceFile> files;
  for (const MessageDefinition& message : *messages) {
    if (!is_built_in(message))
      files.push_back({message.name + ".msg", text_from(message, response.find("type_sources")->as_list())});
  }
  return files;
}

std::string message_text(const MessageDefinition& message) {
  std::string text;
  for (const FieldDefinition& field : message.fields) {
    if (field.name == "structure_needs_at_least_one_member") continue;
    std::string type = to_string(field.type);
    if (const auto kind = type.find("/msg/"); kind != std::string::npos) type.erase(kind, 4);
    text += type + " " + field.name + "\n";
  }
  return text;
}

}  // namespace segue::ros2

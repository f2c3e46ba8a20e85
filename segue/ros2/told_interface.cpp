// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/told_interface.hpp>

#include <segue/base/text.hpp>
#include <segue/ros2/interface_library.hpp>
#include <segue/ros2/interface_names.hpp>
#include <segue/ros2/interface_text.hpp>
#include <segue/ros2/type_hash.hpp>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <set>
#include <utility>

namespace segue::ros2 {
namespace {

using type::Value;

/// Such as "my_msgs/msg/Label", also of a part, and no short form.
bool is_whole_name(const std::string& text) {
  const auto name = parse_interface_name(text);
  return name && to_string(*name) == text;
}

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
  if (is_nested ? !is_whole_name(type.nested) : to_string(type.primitive).empty()) return {};
  return type;
}

Result<MessageDefinition> message_from(const Value& told) {
  MessageDefinition message{told.find("type_name")->as_string()};
  if (!is_whole_name(message.name))
    return fail(ErrorCode::InvalidArgument, quote(message.name) + " is not a valid name of an interface");
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

bool have_same_fields(const MessageDefinition& one, const MessageDefinition& other) {
  return std::ranges::equal(one.fields, other.fields, [](const auto& a, const auto& b) {
    return a.name == b.name && a.type == b.type;
  });
}

bool is_built_in(const MessageDefinition& message) {
  InterfaceLibrary library;
  const auto found = library.find(message.name);
  return found && have_same_fields(**found, message);
}

/// The suffixes of the messages that the sections of its file define.
std::vector<std::string> section_suffixes(const InterfaceName& name) {
  if (name.kind == "srv") return {"_Request", "_Response"};
  if (name.kind == "action") return {"_Goal", "_Result", "_Feedback"};
  return {""};
}

Error refused_type(std::string_view name, const std::string& why) {
  return fail(ErrorCode::InvalidArgument, "type " + std::string(name) + ": " + why);
}

}  // namespace

Result<void> ToldInterfaces::add(const Value& response, std::string_view name) {
  if (!response.find("successful")->as_bool())
    return refused_type(name, "the node does not tell it: " + response.find("failure_reason")->as_string());
  const Value& description = *response.find("type_description");
  Value::List all = description.find("referenced_type_descriptions")->as_list();
  all.insert(all.begin(), *description.find("type_description"));
  for (const Value& one : all) {
    auto message = message_from(one);
    if (!message) return refused_type(name, message.error().message);
    std::string key = message->name;
    messages_.insert_or_assign(std::move(key), std::move(*message));
  }
  for (const Value& source : response.find("type_sources")->as_list()) {
    const auto interface = parse_interface_name(source.find("type_name")->as_string());
    if (interface && source.find("encoding")->as_string() == interface->kind)
      sources_.insert_or_assign(to_string(*interface), source.find("raw_file_contents")->as_string());
  }
  return {};
}

Result<std::vector<const MessageDefinition*>> ToldInterfaces::sections_of(const InterfaceName& name) const {
  std::vector<const MessageDefinition*> all;
  for (const std::string& suffix : section_suffixes(name)) {
    const auto found = messages_.find(to_string(name) + suffix);
    if (found == messages_.end())
      return fail(ErrorCode::NotFound, "the node does not tell " + to_string(name) + suffix);
    all.push_back(&found->second);
  }
  return all;
}

bool ToldInterfaces::is_as_told(const std::vector<MessageDefinition>& messages) const {
  return !messages.empty() && std::ranges::all_of(messages, [&](const MessageDefinition& message) {
    const auto told = messages_.find(message.name);
    return told == messages_.end() || have_same_fields(told->second, message);
  });
}

std::string ToldInterfaces::text_of(const InterfaceName& name,
                                    const std::vector<const MessageDefinition*>& sections) const {
  if (const auto source = sources_.find(to_string(name)); source != sources_.end()) {
    Diagnostics ignored;
    if (is_as_told(read_interface(name, source->second, to_string(name), ignored))) return source->second;
  }
  std::string text;
  for (const MessageDefinition* section : sections)
    text += (section == sections.front() ? "" : "---\n") + message_text(*section);
  return text;
}

Result<std::map<std::string, std::string>> ToldInterfaces::texts_of(const std::string& interface) const {
  std::map<std::string, std::string> texts;
  std::set<std::string> seen{interface};
  for (std::vector<std::string> open{interface}; !open.empty();) {
    const std::string next = std::move(open.back());
    open.pop_back();
    const auto name = parse_interface_name(next);
    if (!name) return name.error();
    const auto sections = sections_of(*name);
    if (!sections) return sections.error();
    if (!std::ranges::all_of(*sections, [](const auto* section) { return is_built_in(*section); }))
      texts.emplace(next, text_of(*name, *sections));
    for (const MessageDefinition* section : *sections) {
      for (const FieldDefinition& field : section->fields) {
        if (field.type.primitive == Primitive::Nested && seen.insert(field.type.nested).second)
          open.push_back(field.type.nested);
      }
    }
  }
  return texts;
}

Result<std::vector<InterfaceFile>> ToldInterfaces::files(const std::string& interface,
                                                         const TypeHashes& hashes) const {
  if (hashes.empty()) return refused_type(interface, "the node does not tell its hash");
  auto texts = texts_of(interface);
  if (!texts) return refused_type(interface, texts.error().message);
  InterfaceLibrary library;
  std::vector<InterfaceFile> files;
  for (auto& [name, text] : *texts) {
    const auto parsed = parse_interface_name(name);
    if (auto done = library.add(*parsed, text); !done) return refused_type(interface, done.error().message);
    files.push_back({name + "." + parsed->kind, std::move(text)});
  }
  for (const auto& [part, hash] : hashes) {
    const auto own = type_hash(library, part);
    if (!own) return refused_type(interface, own.error().message);
    if (*own != hash)
      return refused_type(interface, "what the node tells of " + part + " is another type (" + *own +
                                         ") than it has (" + hash + ")");
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

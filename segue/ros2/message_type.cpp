// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/message_type.hpp>

#include <segue/base/text.hpp>
#include <segue/ros2/interface_names.hpp>
#include <segue/type/memory_layout.hpp>

#include <utility>

namespace segue::ros2 {

namespace {

std::string field_type_name(const FieldType& field) {
  const std::string item = field.primitive == Primitive::Nested ? type_name(field.nested)
                                                                : std::string(port_type(field.primitive));
  switch (field.multiplicity) {
    case Multiplicity::Single:
      return item;
    case Multiplicity::Array:
      return item + "[" + std::to_string(field.capacity) + "]";
    default:
      return "/std/vector<" + item + ">";
  }
}

/// Adds messages to a registry, each after its parts.
class Types {
 public:
  Types(InterfaceLibrary& library, type::TypeRegistry& registry) : library_(library), registry_(registry) {}

  /// Requires that no message contains itself.
  Result<const type::Type*> add(std::string_view name) {
    const auto message = library_.find(name);
    if (!message) return message.error();
    const std::string own = type_name((*message)->name);
    std::vector<std::pair<std::string, const type::Type*>> members;
    for (const FieldDefinition& field : (*message)->fields) {
      const auto its_type = type_of(field, (*message)->name);
      if (!its_type) return its_type.error();
      members.emplace_back(field.name, *its_type);
    }
    auto compound = type::make_compound(own, std::move(members));
    if (!compound) return compound.error();
    if (const type::Type* known = registry_.find(own);
        known != nullptr && type::structural_hash(*known) == type::structural_hash(*compound))
      return known;
    return registry_.add(std::move(*compound));
  }

 private:
  Result<const type::Type*> type_of(const FieldDefinition& field, const std::string& message) {
    if (field.type.primitive == Primitive::Nested) {
      if (auto added = add(field.type.nested); !added) return added;
    } else if (port_type(field.type.primitive).empty()) {
      return fail(ErrorCode::Unsupported, "field " + quote(field.name) + " of " + message +
                                              " is a wstring, which " +
                                              "ROS 2's middlewares encode in different ways");
    }
    const type::Type* found = registry_.find(field_type_name(field.type));
    if (found != nullptr) return found;
    return fail(ErrorCode::Unsupported, "field " + quote(field.name) + " of " + message + " is too large");
  }

  InterfaceLibrary& library_;
  type::TypeRegistry& registry_;
};

}  // namespace

std::string type_name(std::string_view interface_name) {
  const auto parts = split(interface_name, '/');
  return "/" + std::string(parts.front()) + "/" + std::string(parts.back());
}

Result<const type::Type*> message_type(InterfaceLibrary& library, std::string_view name,
                                       type::TypeRegistry& registry) {
  if (auto parts = library.with_parts(name); !parts) return parts.error();  // no message contains itself
  return Types(library, registry).add(name);
}

Result<std::map<std::string, type::Value>> message_defaults(InterfaceLibrary& library,
                                                            std::string_view name) {
  const auto messages = library.with_parts(name);
  if (!messages) return messages.error();
  std::map<std::string, type::Value> defaults;
  for (const MessageDefinition* message : *messages) {
    type::ValueMap members;
    for (const FieldDefinition& field : message->fields) {
      if (field.default_value) members.set(field.name, *field.default_value);
    }
    if (!members.empty()) defaults.emplace(type_name(message->name), std::move(members));
  }
  return defaults;
}

}  // namespace segue::ros2

// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/type/type.hpp>
#include <segue/type/type_graph.hpp>

#include <algorithm>
#include <string>
#include <unordered_set>

namespace segue::type {
namespace detail {

std::vector<const Type*> parts_of(const Type& type) {
  std::vector<const Type*> parts;
  parts.reserve(type.fields.size() + 1);
  for (const Field& field : type.fields) {
    if (field.type != nullptr) parts.push_back(field.type);
  }
  if (type.element != nullptr) parts.push_back(type.element);
  return parts;
}

std::vector<const Type*> reachable_types(const Type& root) {
  std::vector<const Type*> order;
  std::unordered_set<const Type*> seen;
  std::vector<const Type*> open{&root};
  while (!open.empty()) {
    const Type* type = open.back();
    open.pop_back();
    if (!seen.insert(type).second) continue;
    order.push_back(type);
    const std::vector<const Type*> parts = parts_of(*type);
    open.insert(open.end(), parts.rbegin(), parts.rend());
  }
  return order;
}

}  // namespace detail

namespace {

bool is_known_in_itself(const Type& type) {
  switch (type.kind) {
    case TypeKind::Null:
    case TypeKind::Pointer:
      return false;
    case TypeKind::Opaque:
    case TypeKind::Alias:
    case TypeKind::Array:
    case TypeKind::Container:
      return type.element != nullptr;
    case TypeKind::Compound:
      return std::ranges::all_of(type.fields, [](const Field& field) { return field.type != nullptr; });
    case TypeKind::Numeric:
    case TypeKind::Enum:
      break;
  }
  return true;
}

std::string bytes(std::size_t size) {
  if (size == 0) return "size not fixed";
  return counted(size, "byte");
}

std::string name_of(const Type* type) {
  return type == nullptr ? "unknown" : type->name;
}

std::string compound_text(const Type& type) {
  std::string text = "struct " + type.name + " {  // " + bytes(type.size) + "\n";
  for (const Field& field : type.fields) {
    text += "  " + name_of(field.type) + " " + field.name + ";  // at " + std::to_string(field.offset) + "\n";
  }
  return text + "};\n";
}

std::string enum_text(const Type& type) {
  std::string text = "enum " + type.name + " {  // " + bytes(type.size) + "\n";
  for (const EnumSymbol& symbol : type.symbols)
    text += "  " + symbol.name + " = " + std::to_string(symbol.value) + ",\n";
  return text + "};\n";
}

std::string numeric_text(const Type& type) {
  switch (type.category) {
    case NumericCategory::Bool:
      return "boolean";
    case NumericCategory::Float:
      return "floating point";
    case NumericCategory::Signed:
      return "signed integer";
    case NumericCategory::Unsigned:
      break;
  }
  return "unsigned integer";
}

std::string simple_text(const Type& type) {
  switch (type.kind) {
    case TypeKind::Numeric:
      return numeric_text(type);
    case TypeKind::Container:
      return type.container_kind + " of " + name_of(type.element);
    case TypeKind::Array:
      return std::to_string(type.count) + " x " + name_of(type.element);
    case TypeKind::Pointer:
      return "pointer to " + name_of(type.element);
    case TypeKind::Alias:
      return "another name of " + name_of(type.element);
    case TypeKind::Opaque:
      return type.element == nullptr ? "opaque" : "opaque, travels as " + name_of(type.element);
    case TypeKind::Null:
    case TypeKind::Enum:
    case TypeKind::Compound:
      break;
  }
  return "no data";
}

/// Whether the name alone defines the type: "/double", "/std/vector</base/Pose>", "/double[3]".
bool needs_no_definition(const Type& type) {
  switch (type.kind) {
    case TypeKind::Numeric:
    case TypeKind::Null:
    case TypeKind::Array:
    case TypeKind::Container:
    case TypeKind::Pointer:
      return true;
    default:
      return false;
  }
}

std::string definition_text(const Type& type) {
  if (type.kind == TypeKind::Compound) return compound_text(type);
  if (type.kind == TypeKind::Enum) return enum_text(type);
  return type.name + ": " + simple_text(type) + ", " + bytes(type.size) + "\n";
}

}  // namespace

bool Type::is_complete() const {
  return std::ranges::all_of(detail::reachable_types(*this),
                             [](const Type* type) { return is_known_in_itself(*type); });
}

const Type& Type::resolved() const {
  const Type* type = this;
  while (type->kind == TypeKind::Alias && type->element != nullptr)
    type = type->element;
  return *type;
}

std::string definition(const Type& type) {
  std::string text;
  for (const Type* part : detail::reachable_types(type)) {
    if (part == &type || !needs_no_definition(*part)) text += definition_text(*part);
  }
  return text;
}

}  // namespace segue::type

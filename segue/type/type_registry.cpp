// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/type/composite_type.hpp>
#include <segue/type/type.hpp>
#include <segue/type/type_graph.hpp>

#include <array>
#include <optional>
#include <unordered_map>
#include <utility>

namespace segue::type {
namespace {

struct Number {
  std::string_view name;
  NumericCategory category;
  std::size_t size;
  std::int64_t nanoseconds_per_tick = 0;
};

constexpr std::array<Number, 17> kNumbers = {{
    {"/bool", NumericCategory::Bool, 1},
    {"/int8_t", NumericCategory::Signed, 1},
    {"/int16_t", NumericCategory::Signed, 2},
    {"/int32_t", NumericCategory::Signed, 4},
    {"/int64_t", NumericCategory::Signed, 8},
    {"/uint8_t", NumericCategory::Unsigned, 1},
    {"/uint16_t", NumericCategory::Unsigned, 2},
    {"/uint32_t", NumericCategory::Unsigned, 4},
    {"/uint64_t", NumericCategory::Unsigned, 8},
    {"/float", NumericCategory::Float, 4},
    {"/double", NumericCategory::Float, 8},
    {"/std/chrono/nanoseconds", NumericCategory::Signed, 8, 1},
    {"/std/chrono/microseconds", NumericCategory::Signed, 8, 1'000},
    {"/std/chrono/milliseconds", NumericCategory::Signed, 8, 1'000'000},
    {"/std/chrono/seconds", NumericCategory::Signed, 8, 1'000'000'000},
    {"/std/chrono/minutes", NumericCategory::Signed, 8, 60'000'000'000},
    {"/std/chrono/hours", NumericCategory::Signed, 8, 3'600'000'000'000},
}};

Type number(const Number& of) {
  Type type;
  type.kind = TypeKind::Numeric;
  type.name = of.name;
  type.size = of.size;
  type.category = of.category;
  type.nanoseconds_per_tick = of.nanoseconds_per_tick;
  return type;
}

/// Follows aliases and opaques; their target must exist.
bool leads_in_a_circle(const Type& type) {
  const Type* slow = &type;
  const Type* fast = &type;
  const auto step = [](const Type* t) {
    const bool follows = t->kind == TypeKind::Alias || t->kind == TypeKind::Opaque;
    return follows ? t->element : nullptr;
  };
  while (fast != nullptr && (fast = step(fast)) != nullptr) {
    if (fast = step(fast); fast == nullptr) return false;
    slow = step(slow);
    if (slow == fast) return true;
  }
  return false;
}

}  // namespace

struct TypeRegistry::Implementation {
  std::vector<std::unique_ptr<Type>> types;
  std::unordered_map<std::string, const Type*> by_name;

  const Type* lookup(const std::string& name) const {
    const auto found = by_name.find(name);
    return found == by_name.end() ? nullptr : found->second;
  }

  bool owns(const Type* type) const { return type == nullptr || lookup(type->name) == type; }

  const Type* take(std::unique_ptr<Type> type) {
    const Type* address = type.get();
    by_name.emplace(type->name, address);
    types.push_back(std::move(type));
    return address;
  }

  const Type* take(Type type) { return take(std::make_unique<Type>(std::move(type))); }

  const Type* build(const detail::CompositeName& composite, const Type& element) {
    std::optional<Type> type = detail::make_composite(composite, element);
    if (!type) return nullptr;
    const Type* known = lookup(type->name);
    return known != nullptr ? known : take(std::move(*type));
  }
};

TypeRegistry::TypeRegistry() : implementation_(std::make_unique<Implementation>()) {
  for (const Number& of : kNumbers)
    implementation_->take(number(of));
  Type nil;
  nil.name = "/nil";
  implementation_->take(std::move(nil));
  Type text;
  text.kind = TypeKind::Container;
  text.name = "/std/string";
  text.container_kind = "/std/string";
  text.element = implementation_->lookup("/int8_t");
  text.size = sizeof(std::string);
  implementation_->take(std::move(text));
}

TypeRegistry::~TypeRegistry() = default;
TypeRegistry::TypeRegistry(TypeRegistry&&) noexcept = default;
TypeRegistry& TypeRegistry::operator=(TypeRegistry&&) noexcept = default;

const Type* TypeRegistry::find(std::string_view name) const {
  if (const Type* exact = implementation_->lookup(std::string(name))) return exact;
  const Result<std::string> canonical = canonical_type_name(name);
  return canonical ? implementation_->lookup(*canonical) : nullptr;
}

const Type* TypeRegistry::find(std::string_view name) {
  if (const Type* known = std::as_const(*this).find(name)) return known;
  const Result<std::string> canonical = canonical_type_name(name);
  if (!canonical) return nullptr;
  // By the name as written first: in a registry of another machine "/long" may have four bytes.
  for (const std::string_view spelling : {name, std::string_view(*canonical)}) {
    const detail::CompositeName composite = detail::split_composite(spelling);
    const Type* element = composite.kind == TypeKind::Null ? nullptr : find(composite.element);
    if (element != nullptr) return implementation_->build(composite, element->resolved());
  }
  return nullptr;
}

Result<const Type*> TypeRegistry::add(Type type) {
  const Result<std::string> canonical = canonical_type_name(type.name);
  if (!canonical) return canonical.error();
  if (type.kind != TypeKind::Alias || implementation_->lookup(*canonical) == nullptr) type.name = *canonical;
  if (const Type* known = implementation_->lookup(type.name)) {
    if (structural_hash(*known) == structural_hash(type)) return known;
    return fail(ErrorCode::AlreadyExists, "two different types are named " + quote(type.name) + ":\n" +
                                              definition(*known) + definition(type));
  }
  std::vector<std::unique_ptr<Type>> one;
  one.push_back(std::make_unique<Type>(std::move(type)));
  const Type* address = one.front().get();
  if (auto added = add_all(std::move(one)); !added) return added.error();
  return address;
}

Result<void> TypeRegistry::add_all(std::vector<std::unique_ptr<Type>> types) {
  std::unordered_map<std::string_view, const Type*> fresh;
  for (const auto& type : types) {
    if (leads_in_a_circle(*type))
      return fail(ErrorCode::InvalidArgument, "type " + quote(type->name) + " stands for itself");
    if (implementation_->lookup(type->name) != nullptr || !fresh.emplace(type->name, type.get()).second)
      return fail(ErrorCode::AlreadyExists, "type " + quote(type->name) + " is registered twice");
  }
  for (const auto& type : types) {
    for (const Type* part : detail::parts_of(*type)) {
      const auto found = fresh.find(part->name);
      const bool among_them = found != fresh.end() && found->second == part;
      if (!among_them && !implementation_->owns(part))
        return fail(ErrorCode::InvalidArgument, "type " + quote(type->name) + " is made of " +
                                                    quote(part->name) + ", which is not of this registry");
    }
  }
  for (auto& type : types)
    implementation_->take(std::move(type));
  return {};
}

std::vector<const Type*> TypeRegistry::types() const {
  std::vector<const Type*> result;
  result.reserve(implementation_->types.size());
  for (const auto& type : implementation_->types)
    result.push_back(type.get());
  return result;
}

Result<void> TypeRegistry::copy_in(const std::vector<const Type*>& others) {
  std::unordered_map<const Type*, const Type*> here;
  std::vector<std::unique_ptr<Type>> copies;
  for (const Type* other : others) {
    const Type* known = implementation_->lookup(other->name);
    if (known == nullptr) {
      copies.push_back(std::make_unique<Type>(*other));
      known = copies.back().get();
    } else if (known != other && structural_hash(*known) != structural_hash(*other)) {
      return fail(ErrorCode::AlreadyExists, "two different types are named " + quote(other->name) + ":\n" +
                                                definition(*known) + definition(*other));
    }
    here.emplace(other, known);
  }
  for (const auto& copy : copies) {
    if (copy->element != nullptr) copy->element = here.at(copy->element);
    for (Field& field : copy->fields)
      field.type = field.type == nullptr ? nullptr : here.at(field.type);
  }
  return add_all(std::move(copies));
}

Result<void> TypeRegistry::merge(const TypeRegistry& other) {
  return copy_in(other.types());
}

Result<const Type*> TypeRegistry::copy(const Type& type) {
  if (auto copied = copy_in(detail::reachable_types(type)); !copied) return copied.error();
  return implementation_->lookup(type.name);
}

}  // namespace segue::type

// SPDX-License-Identifier: Apache-2.0
#include <segue/type/described_type.hpp>
#include <segue/type/possible_types.hpp>

#include <algorithm>
#include <ranges>

namespace segue::type::detail {
namespace {

/// Whether flat.cpp supports the type itself, apart from its parts.
bool is_known(const DescribedType& described) {
  if (described.grid.size != nullptr || described.info.trivially_copyable) return true;
  switch (described.shape->type.kind) {
    case TypeKind::Compound:
    case TypeKind::Array:
      return described.conversion.to_value == nullptr;
    case TypeKind::Container:
      return has_items(described);
    default:
      return false;
  }
}

bool parts_are_possible(const DescribedType& described) {
  if (described.grid.size != nullptr || described.info.trivially_copyable) return true;
  const Shape& shape = *described.shape;
  if (shape.element != nullptr) return shape.element->flat.possible;
  return std::ranges::all_of(shape.fields, [](const DescribedField& f) { return f.type->flat.possible; });
}

/// Requires a type that is copied as bytes, which cannot contain itself.
bool has_enum_or_boolean(const DescribedType& described) {
  const Shape& shape = *described.shape;
  if (shape.type.kind == TypeKind::Enum) return true;
  if (shape.type.kind == TypeKind::Numeric) return shape.type.category == NumericCategory::Bool;
  if (shape.element != nullptr) return has_enum_or_boolean(*shape.element);
  return std::ranges::any_of(shape.fields,
                             [](const DescribedField& field) { return has_enum_or_boolean(*field.type); });
}

/// Containers may be empty, so the search ends at them.
std::size_t least_size(const DescribedType& described) {
  const Shape& shape = *described.shape;
  if (described.grid.size != nullptr) return 2 * sizeof(std::uint64_t);
  if (described.info.trivially_copyable) return described.info.size;
  if (shape.type.kind == TypeKind::Container) return shape.type.is_optional() ? 1 : sizeof(std::uint64_t);
  if (shape.element != nullptr) return shape.type.count * least_size(*shape.element);
  std::size_t least = shape.fields.empty() ? 1 : 0;
  for (const DescribedField& field : shape.fields)
    least += least_size(*field.type);
  return least;
}

}  // namespace

void plan_flat(std::span<DescribedType* const> fresh) {
  find_possible(
      fresh, [](DescribedType& type) -> bool& { return type.flat.possible; }, is_known, parts_are_possible);
  for (DescribedType* described : fresh) {
    described->flat.checked = described->info.trivially_copyable && has_enum_or_boolean(*described);
    described->flat.least = least_size(*described);
  }
}

}  // namespace segue::type::detail

// SPDX-License-Identifier: Apache-2.0
#include <segue/type/memory_layout.hpp>

#include <segue/base/text.hpp>

#include <algorithm>
#include <limits>

namespace segue::type {

namespace {

constexpr std::size_t kLargestObject = std::numeric_limits<std::size_t>::max() / 4;

Result<MemoryLayout> no_layout(const Type& type) {
  return fail(ErrorCode::Unsupported, "objects of type " + quote(type.name) + " cannot be made at run time");
}

std::size_t rounded_up(std::size_t offset, std::size_t alignment) {
  return (offset + alignment - 1) / alignment * alignment;
}

Result<MemoryLayout> container_layout(const Type& type) {
  if (type.is_string()) return MemoryLayout{sizeof(std::string), alignof(std::string)};
  if (type.container_kind != "/std/vector" || type.element == nullptr) return no_layout(type);
  const Type& element = type.element->resolved();
  const bool is_bits = element.kind == TypeKind::Numeric && element.category == NumericCategory::Bool;
  return is_bits ? MemoryLayout{sizeof(std::vector<bool>), alignof(std::vector<bool>)}
                 : MemoryLayout{sizeof(std::vector<int>), alignof(std::vector<int>)};
}

Result<MemoryLayout> array_layout(const Type& type) {
  const auto element = memory_layout(*type.element);
  if (!element) return element;
  if (type.count == 0 || element->size > kLargestObject / type.count) return no_layout(type);
  return MemoryLayout{element->size * type.count, element->alignment};
}

}  // namespace

Result<MemoryLayout> memory_layout(const Type& type) {
  switch (type.kind) {
    case TypeKind::Numeric:
    case TypeKind::Enum:
      return MemoryLayout{type.size, type.size};
    case TypeKind::Alias:
      return memory_layout(type.resolved());
    case TypeKind::Array:
      return array_layout(type);
    case TypeKind::Container:
      return container_layout(type);
    case TypeKind::Compound: {
      MemoryLayout whole{type.size, 1};
      for (const Field& field : type.fields) {
        const auto part = memory_layout(*field.type);
        if (!part) return part;
        whole.alignment = std::max(whole.alignment, part->alignment);
      }
      return whole;
    }
    default:
      return no_layout(type);
  }
}

Result<Type> make_compound(std::string name, std::vector<std::pair<std::string, const Type*>> members) {
  Type type;
  type.kind = TypeKind::Compound;
  type.name = std::move(name);
  std::size_t end = 0;
  std::size_t alignment = 1;
  for (auto& [member, its_type] : members) {
    const auto layout = memory_layout(*its_type);
    if (!layout) return layout.error();
    const std::size_t offset = rounded_up(end, layout->alignment);
    if (layout->size > kLargestObject - offset)
      return fail(ErrorCode::Unsupported, quote(type.name) + " is too large");
    type.fields.push_back({std::move(member), its_type, offset});
    end = offset + layout->size;
    alignment = std::max(alignment, layout->alignment);
  }
  type.size = std::max<std::size_t>(rounded_up(end, alignment), 1);
  return type;
}

}  // namespace segue::type

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/type.hpp>

#include <optional>
#include <string_view>

namespace segue::type::detail {

/// What a name such as "/double[3]", "/base/Pose*" or "/std/vector</double>" says: of what it is made. Null
/// for all other names.
struct CompositeName {
  TypeKind kind = TypeKind::Null;
  std::string_view element;
  std::string_view container_kind;
  std::size_t count = 0;
};

CompositeName split_composite(std::string_view name);

/// The array, container or pointer of that element, named after it; nothing where it would not fit into any
/// memory.
std::optional<Type> make_composite(const CompositeName& composite, const Type& element);

}  // namespace segue::type::detail

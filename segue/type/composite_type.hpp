// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/type.hpp>

#include <optional>
#include <string_view>

namespace segue::type::detail {

/// The parts of a composite name such as "/double[3]", "/base/Pose*" or "/std/vector</double>". Kind Null for
/// all other names.
struct CompositeName {
  TypeKind kind = TypeKind::Null;
  std::string_view element;
  std::string_view container_kind;
  std::size_t count = 0;
};

CompositeName split_composite(std::string_view name);

/// The array, container or pointer type with that element; nothing where its size would overflow.
std::optional<Type> make_composite(const CompositeName& composite, const Type& element);

}  // namespace segue::type::detail

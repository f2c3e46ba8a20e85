// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/type/type.hpp>

#include <span>
#include <unordered_map>
#include <vector>

namespace segue::type::detail {

inline constexpr std::size_t kNoField = static_cast<std::size_t>(-1);

/// A contradiction in the layout of a type; `field` is the index of the field concerned, or kNoField.
struct LayoutProblem {
  Severity severity = Severity::Error;
  std::string code;
  std::string message;
  const Type* type = nullptr;
  std::size_t field = kNoField;
};

/// Sizes of types that differ in the file from this machine (std::string).
using TypeSizes = std::unordered_map<const Type*, std::size_t>;

/// Reports fields outside their compound (error) or overlapping (warning, since unions and bit fields look
/// like that), types that contain themselves other than through a container or pointer, and nesting beyond
/// 200 levels. Sizes of pointers and of long depend on the machine where the file was written and are not
/// checked.
std::vector<LayoutProblem> check_layouts(std::span<const Type* const> types, const TypeSizes& sizes);

}  // namespace segue::type::detail

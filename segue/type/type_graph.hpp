// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/type.hpp>

#include <vector>

namespace segue::type::detail {

/// The types a type is directly made of: fields, element, what an alias stands for. Null pointers are left
/// out.
std::vector<const Type*> parts_of(const Type& type);

/// The type and all it is made of, each once, itself first. Never recurses: types may be nested deeply.
std::vector<const Type*> reachable_types(const Type& root);

}  // namespace segue::type::detail

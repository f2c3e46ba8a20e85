// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/type.hpp>

#include <vector>

namespace segue::type::detail {

/// The direct parts of a type: fields, element, target of an alias. Null pointers are left out.
std::vector<const Type*> parts_of(const Type& type);

/// The type and all its direct and indirect parts, each once, itself first. Iterative, since types may be
/// nested deeply.
std::vector<const Type*> reachable_types(const Type& root);

}  // namespace segue::type::detail

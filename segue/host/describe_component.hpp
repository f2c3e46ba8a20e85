// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/task/component.hpp>
#include <segue/type/type.hpp>

namespace segue::host::detail {

/// Adds the types of a component's ports, properties and operations to `types`, with all that they are made
/// of.
Result<void> add_types(const task::Component& component, type::TypeRegistry& types);

/// Adds one type with all that it is made of; types that are there already stay.
Result<void> add_type(const type::Type& type, type::TypeRegistry& types);

}  // namespace segue::host::detail

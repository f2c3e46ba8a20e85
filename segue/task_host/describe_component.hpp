// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/task/component.hpp>
#include <segue/type/type.hpp>

namespace segue::task_host::detail {

/// Adds the types of a component's ports, properties and operations to `types`, and all types that these
/// consist of.
Result<void> add_types(const task::Component& component, type::TypeRegistry& types);

/// Adds a type and all types that it consists of; existing types stay.
Result<void> add_type(const type::Type& type, type::TypeRegistry& types);

}  // namespace segue::task_host::detail

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/reader.hpp>
#include <segue/type/type.hpp>

#include <vector>

/// The `types` of a component model file. Internal.
namespace segue::model::detail {

/// Definitions of the types and all that they are made of, by name; what every registry has is left out.
type::Value write_types(const std::vector<const type::Type*>& types);

/// Adds the definitions to the registry; a contradiction to what is there is an error.
void read_types(const type::Value& definitions, type::TypeRegistry& registry, const Source& source);

}  // namespace segue::model::detail

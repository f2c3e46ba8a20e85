// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/component_model.hpp>
#include <segue/type/value.hpp>

namespace segue::runtime {

/// The names of the libraries of a robot's components, each once.
type::Value component_libraries(const model::ComponentCatalog& catalog);

}  // namespace segue::runtime

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/component_model.hpp>
#include <segue/model/network.hpp>
#include <segue/runtime/controller_set.hpp>

#include <optional>

/// Recognises the controller that runs, for a runtime that has just begun or has lost track of its robot.
namespace segue::runtime::detail {

/// The name of the controller, or of the union of several, that just this network is; empty: of none. Of
/// controllers that are equal, the first.
model::NetworkName name_of(const model::Network& observed, const Controllers& controllers,
                           const model::ComponentCatalog& catalog);

/// The controller, or the union of several, that runs in this network, as its file defines it but for the
/// properties of its tasks, which may have been set since; it has a version only where none was. Beside it
/// there may be tasks that do not run, such as those of controllers that are kept ready. Nothing where there
/// is none, or where controllers differ in nothing but those properties.
std::optional<model::Network> running_controller(const model::Network& observed,
                                                 const Controllers& controllers,
                                                 const model::ComponentCatalog& catalog);

}  // namespace segue::runtime::detail

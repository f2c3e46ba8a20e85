// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/model/component_model.hpp>
#include <segue/model/network.hpp>
#include <segue/model/transition.hpp>
#include <segue/model/validate.hpp>

#include <vector>

namespace segue::solve {

/// The problems of transitions that are written by hand, with their places: each begins at the controller
/// that its `from` names (the empty network where it names none; several, joined by '+', at once). Errors: a
/// controller that does not exist, the first action that is not possible in its order (predict()), and a
/// result that is no valid network, to the depth. A warning: `to` names a controller, and the result is
/// another network. `controllers` must be valid.
Diagnostics check_transitions(const std::vector<model::Transition>& transitions,
                              const std::vector<model::Network>& controllers,
                              const model::ComponentCatalog& catalog, model::Depth depth);

}  // namespace segue::solve

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/component_model.hpp>
#include <segue/model/network.hpp>

namespace segue::solve {

/// Adds to `running` the parts of `wanted` that can exist beside it on standby: processes whose names are
/// free; tasks whose ids and placements are free, and the connections among them. Standby tasks are
/// configured (Stopped), or only created (PreOperational) if that is their target state or another task holds
/// one of their devices. Hence the transition from `running` to the result has only a prepare phase, and the
/// one from the result to `wanted` deploys, creates and configures nothing that could have been prepared.
/// Both networks must have passed validation of structure; unknown components are assumed to have static
/// ports and no devices. Pure; linear in the size of the networks.
model::Network with_standby(const model::Network& running, const model::Network& wanted,
                            const model::ComponentCatalog& catalog);

}  // namespace segue::solve

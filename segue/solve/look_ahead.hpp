// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/component.hpp>
#include <segue/model/network.hpp>

namespace segue::solve {

/// `running`, untouched, and beside it what of `wanted` can be there already: its processes, unless another
/// one of that name is there; its tasks whose ids and places are free, configured (Stopped), or only made
/// (PreOperational) where that is their target or where somebody holds one of their devices; and the
/// connections among them. So the transition from `running` to the result is all of it prepare, and the one
/// from the result to `wanted` deploys, makes and configures nothing that could be prepared. Both must have
/// passed validation of structure; components that `catalog` lacks count as having static ports and no
/// devices. Pure; linear in the size of the networks.
model::Network warmed(const model::Network& running, const model::Network& wanted,
                      const model::ComponentCatalog& catalog);

}  // namespace segue::solve

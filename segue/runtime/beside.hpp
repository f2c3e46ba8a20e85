// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/network.hpp>

/// Networks as sets: what a robot runs is its controller and, beside it, what is kept ready for the next one
/// or was left over. Linear in the size of the networks.
namespace segue::runtime::detail {

/// Everything of `first`, and what of `second` it lacks: tasks by id, processes by key (with the placements
/// of both), connections. The name is that of `first`.
model::Network together(model::Network first, const model::Network& second);

/// What of `all` is not in `part`: tasks by id, processes by key (of a common one the placements of the tasks
/// that are left), connections. Without a name.
model::Network without(const model::Network& all, const model::Network& part);

/// Whether `all` has everything of `part`, each exactly as `part` has it.
bool has_all_of(const model::Network& all, const model::Network& part);

}  // namespace segue::runtime::detail

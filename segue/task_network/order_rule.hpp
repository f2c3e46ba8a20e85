// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace segue::task_network {

/// How the order of a task network is derived (derive_order).
/// Epoch: every linear extension reads the same values and ends in the same world as the sequential
/// execution; found in one walk, linear in the accesses. Goal: only preconditions and the network's goal are
/// kept (causal links from the earliest producer, threats), facts under conditions as in Epoch; it needs the
/// whole network, and resources that are only blocked keep no order.
enum class OrderRule : std::uint8_t { Epoch, Goal };

}  // namespace segue::task_network

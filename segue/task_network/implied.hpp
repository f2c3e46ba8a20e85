// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task_network/order.hpp>
#include <segue/task_network/task_network.hpp>

#include <vector>

namespace segue::task_network {

/// Dependencies between nodes further apart are not examined and count as needed.
inline constexpr std::uint32_t kImpliedWithin = 1024;

/// For each dependency, by its place in the order: whether a run would be the same without it, because a path
/// of other dependencies connects the two nodes. A data dependency is never implied; a condition is implied
/// only by another condition within it. Time and memory are linear in the number of dependencies.
std::vector<bool> implied_dependencies(const TaskNetwork& network, const Order& order);

}  // namespace segue::task_network

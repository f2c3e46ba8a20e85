// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/cdtn/order.hpp>
#include <segue/cdtn/task_network.hpp>

#include <vector>

namespace segue::cdtn {

/// Nodes further apart are not looked at: such dependencies count as needed.
inline constexpr std::uint32_t kImpliedWithin = 1024;

/// By place in the order: whether a run would be the same without this dependency, since others lead from the
/// one node to the other. Data never is, as something flows; a condition is where one that is kept lies
/// within it. Time and memory are linear in the dependencies.
std::vector<bool> implied_dependencies(const TaskNetwork& network, const Order& order);

}  // namespace segue::cdtn

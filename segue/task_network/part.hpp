// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task_network/task_network.hpp>

#include <vector>

namespace segue::task_network {

/// Some nodes of a network as a network of their own, in which nothing refers to the others.
struct NetworkPart {
  TaskNetwork network;
  std::vector<NodeId> nodes;  ///< by node of the part: which one it is
};

/// The part that consists of the nodes that are kept, which are by node. Without names and group locks.
[[nodiscard]] NetworkPart part_of(const TaskNetwork& network, const std::vector<bool>& keep);

}  // namespace segue::task_network

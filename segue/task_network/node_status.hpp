// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace segue::task_network {

/// The state of a node at the end of a run.
enum class NodeStatus : std::uint8_t { NotReached, Done, Skipped, Failed, Preempted };

}  // namespace segue::task_network

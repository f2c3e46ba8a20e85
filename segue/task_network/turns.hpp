// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task_network/node_ids.hpp>

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace segue::task_network {

/// Nodes that wait until others have passed. Mostly there are none, and then it costs nothing.
class Turns {
 public:
  void wait(NodeId node, NodeId until) {
    std::vector<NodeId>& waiting = waiting_[index(until)];
    if (waiting.empty() || waiting.back() != node) waiting.push_back(node);
  }
  /// Adds those that have waited for the node to `work`.
  void passed(NodeId node, std::vector<NodeId>& work) {
    if (waiting_.empty()) return;
    const auto found = waiting_.extract(index(node));
    if (!found.empty()) work.insert(work.end(), found.mapped().begin(), found.mapped().end());
  }

 private:
  std::unordered_map<std::uint32_t, std::vector<NodeId>> waiting_;  ///< by the node that is waited for
};

}  // namespace segue::task_network

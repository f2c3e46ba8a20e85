// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task_network/fact.hpp>
#include <segue/task_network/node_ids.hpp>

#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

namespace segue::task_network {

/// The assumptions of a run about the world, where the world was not yet certain.
struct WorldGuess {
  std::vector<Literal> facts;
  std::uint64_t history = 0;  ///< VersionedWorld::history()
};

/// Effects of opaque nodes on facts that these do not declare.
class UndeclaredEffects {
 public:
  void add(NodeId node, const Literal& literal) {
    auto& writes = by_fact_[index(literal.fact)];
    if (!writes.empty() && writes.back().first == node)
      writes.back().second = literal.value;
    else
      writes.emplace_back(node, literal.value);
    by_node_[index(node)].push_back(literal);
  }

  /// In the order in which they happened.
  [[nodiscard]] std::span<const Literal> of(NodeId node) const {
    const auto found = by_node_.find(index(node));
    return found == by_node_.end() ? std::span<const Literal>() : found->second;
  }

  /// The value that the last node has left of those from `first` on that lie before `before` in program
  /// order.
  [[nodiscard]] std::optional<bool> last(FactId fact, NodeId first, NodeId before) const {
    const auto found = by_fact_.find(index(fact));
    if (found == by_fact_.end()) return std::nullopt;
    const std::pair<NodeId, bool>* last = nullptr;
    for (const auto& write : found->second) {
      const bool between = write.first < before && write.first >= first;
      if (between && (last == nullptr || write.first > last->first)) last = &write;
    }
    return last == nullptr ? std::nullopt : std::optional(last->second);
  }

 private:
  std::unordered_map<std::uint32_t, std::vector<std::pair<NodeId, bool>>> by_fact_;
  std::unordered_map<std::uint32_t, std::vector<Literal>> by_node_;
};

}  // namespace segue::task_network

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task_network/resource_pool.hpp>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <set>
#include <vector>

namespace segue::task_network {

/// Nodes that hold their units and wait to begin: first those that are certain to count, and each kind by
/// rank. Internal to ConcurrentEngine.
class ReadyNodes {
 public:
  void add(const Rank& rank, bool certain) { (certain ? certain_ : speculative_).insert(rank); }
  void remove(const Rank& rank) {
    certain_.erase(rank);
    speculative_.erase(rank);
  }
  /// True if it was added as one that is not certain to count.
  bool remove_speculative(const Rank& rank) { return speculative_.erase(rank) > 0; }
  /// Moves out the first node that `may_begin`; with `ahead` also one that is not certain to count.
  template <class MayBegin>
  std::optional<NodeId> take_first(bool ahead, const MayBegin& may_begin) {
    if (const auto node = take_first(certain_, may_begin)) return node;
    return ahead ? take_first(speculative_, may_begin) : std::nullopt;
  }
  [[nodiscard]] bool empty() const { return certain_.empty() && speculative_.empty(); }
  [[nodiscard]] std::size_t certain_count() const { return certain_.size(); }
  [[nodiscard]] bool has_speculative() const { return !speculative_.empty(); }
  [[nodiscard]] std::vector<NodeId> all() const {
    std::vector<NodeId> nodes;
    for (const auto* from : {&certain_, &speculative_}) {
      for (const Rank& each : *from)
        nodes.push_back(each.node);
    }
    return nodes;
  }

 private:
  template <class MayBegin>
  static std::optional<NodeId> take_first(std::set<Rank>& from, const MayBegin& may_begin) {
    const auto first = std::ranges::find_if(from, may_begin, &Rank::node);
    if (first == from.end()) return std::nullopt;
    const NodeId node = first->node;
    from.erase(first);
    return node;
  }

  std::set<Rank> certain_;
  std::set<Rank> speculative_;
};

}  // namespace segue::task_network

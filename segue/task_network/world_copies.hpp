// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task_network/resource_pool.hpp>

#include <cstdint>
#include <set>

namespace segue::task_network {

/// The copies of the world that runs on a projection hold, and the nodes that wait for one. Not thread safe.
class WorldCopies {
 public:
  /// `most` at the same time; 0: any number, and then nobody takes one.
  explicit WorldCopies(std::uint32_t most) : most_(most) {}

  [[nodiscard]] bool are_limited() const { return most_ > 0; }
  [[nodiscard]] bool are_all_taken() const { return taken_ >= most_; }
  void take() { ++taken_; }
  void put_back() { --taken_; }

  void wait(Rank node) { waiting_.insert(node); }
  void give_up(Rank node) { waiting_.erase(node); }
  /// Calls `found` with as many nodes as there are free copies, the first in rank; they wait no longer.
  template <class Found>
  void for_each_that_may_try(Found found) {
    for (std::uint32_t free = most_ - taken_; free > 0 && !waiting_.empty(); --free) {
      const NodeId node = waiting_.begin()->node;
      waiting_.erase(waiting_.begin());
      found(node);
    }
  }

 private:
  std::uint32_t most_;
  std::uint32_t taken_ = 0;
  std::set<Rank> waiting_;
};

}  // namespace segue::task_network

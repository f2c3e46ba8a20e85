// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task_network/order_builder.hpp>

#include <cstdint>
#include <vector>

namespace segue::task_network {

/// Implements OrderRule::Goal: keeps only the values of facts that a precondition or the goal needs. Internal
/// to derive_order.
class GoalOrder {
 public:
  /// All must outlive this. `further`: as for derive_order.
  GoalOrder(const TaskNetwork& network, Order& order, std::vector<Dependency>* further);
  void derive();

 private:
  struct Link {
    NodeId from{};
    NodeId to{};
    FactId fact{};
  };
  /// A section of the program in which the fact has the value: its producer (none: the initial world), and
  /// whether any node needs it.
  struct Interval {
    bool has_producer = false;
    bool needed = false;
    NodeId producer{kNone};
  };
  void collect_facts();
  [[nodiscard]] bool foreseeable(FactId fact) const;
  void add_links(const Literal& literal);
  void need(Interval& interval, FactId fact);
  void link(NodeId from, NodeId to, FactId fact);
  [[nodiscard]] std::vector<Literal> wanted() const;

  const TaskNetwork& network_;
  OrderBuilder builder_;
  bool opaque_ = false;  ///< some node may change any fact
  std::vector<std::uint32_t> fact_begin_;
  std::vector<std::uint32_t> by_fact_;  ///< accesses, by fact and program order
  std::vector<NodeId> readers_;
  std::vector<NodeId> clobberers_;
  std::vector<Literal> goal_;  ///< required values of the fact being processed
  std::vector<Link> links_;
};

}  // namespace segue::task_network

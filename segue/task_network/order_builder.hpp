// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task_network/order.hpp>

#include <cstdint>
#include <vector>

namespace segue::task_network {

/// Derives the order by the epoch rule for a network that grows. Each fact's sequence of accesses is cut
/// where its value flips: the flipping node comes after every node that touched the fact since the last flip,
/// and those come after the last flip. So the flips of a fact are totally ordered, and every other access
/// stays between the same two. Nodes in parallel that flip a fact to the same value are one flip together:
/// none waits for the others, and what comes after waits for all.
class OrderBuilder {
 public:
  /// All must outlive the builder. `further`: as for derive_order.
  OrderBuilder(const TaskNetwork& network, Order& order, std::vector<Dependency>* further = nullptr)
      : network_(network), order_(order), further_(further) {}
  /// Takes in all nodes that were appended since.
  void extend();

 private:
  friend class GoalOrder;
  struct Member {
    NodeId node{};
    std::uint32_t next = kNone;
    bool relies = false;  ///< on a value that another flip of the same epoch could change
  };
  /// Lists of members_, newest first.
  struct Epoch {
    std::uint32_t flips = kNone;     ///< the nodes that gave the fact its value; none: the initial world
    std::uint32_t touchers = kNone;  ///< nodes that touched it since
  };
  struct FactState {
    Epoch now;
    Epoch before;
    std::uint8_t value = 0;
    bool uncertain = false;
    bool seen = false;
  };
  /// The nodes whose starts the next user of a resource waits for: the last one that took units, and members
  /// of a group lock that have only relied on it since.
  struct LastClaims {
    NodeId node{kNone};
    std::vector<NodeId> members{};
  };
  void add(NodeId from, Reason reason, std::uint32_t subject);
  void add_access(NodeId node, const Access& access);
  void keep(FactState& state, NodeId node, const Access& access, bool known);
  void flip(FactState& state, NodeId node, const Access& access);
  void join_flip(FactState& state, NodeId node, const Access& access);
  bool wait_for(const Epoch& epoch, NodeId node, const Access& access, bool agrees);
  bool drop_those_before(std::uint32_t& list, NodeId node);
  void add_place(NodeId node);
  void add_resources(NodeId node, bool blocks_in_order);
  void add_data_and_conditions(NodeId node);
  void list(std::uint32_t& list, NodeId node, bool relies = false);
  [[nodiscard]] bool known_to(const FactState& state, NodeId node) const;
  [[nodiscard]] bool may_be_joined(const FactState& state) const;
  [[nodiscard]] bool is_after_place(NodeId node) const { return index(place_) == kNone || node > place_; }
  void prepare();
  void begin_node(NodeId node);
  void end_node() { order_.close_node(); }
  void end() { order_.link(); }

  const TaskNetwork& network_;
  Order& order_;
  std::vector<Dependency>* further_;
  std::vector<FactState> states_;  ///< by fact
  std::vector<Member> members_;
  std::vector<NodeId> waited_;             ///< of wait_for()
  std::vector<LastClaims> last_claims_;    ///< by resource
  std::vector<std::uint32_t> waited_for_;  ///< by node: the last node with a dependency on it
  NodeId place_{kNone};                    ///< the last opaque node
  std::uint32_t place_touchers_ = kNone;
};

}  // namespace segue::task_network

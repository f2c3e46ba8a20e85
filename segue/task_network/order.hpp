// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task_network/node_ids.hpp>
#include <segue/task_network/order_rule.hpp>
#include <segue/task_network/task_network.hpp>

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <ranges>
#include <span>
#include <string>
#include <vector>

namespace segue::task_network {

/// Why a node comes after another.
enum class Reason : std::uint8_t {
  Fact,       ///< one of them changes a fact that the other relies on or changes
  Resource,   ///< both use a resource whose order matters: it starts after the other's *start*
  Data,       ///< it takes an output of the other
  Condition,  ///< the other's outcome decides whether it is on the path
  Place       ///< one of them is opaque: it may touch anything
};
std::string_view to_string(Reason reason);

/// `to` comes after `from` because of `subject`: a fact, a resource, an input's name or an outcome.
struct Dependency {
  NodeId from{};
  NodeId to{};
  std::uint32_t subject : 29 = 0;
  std::uint32_t reason_bits : 3 = 0;
  [[nodiscard]] Reason reason() const { return static_cast<Reason>(reason_bits); }
};
[[nodiscard]] Dependency dependency(NodeId from, NodeId to, Reason reason, std::uint32_t subject);

/// The dependencies between nodes, with their reasons, in flat arrays: those of a node are adjacent, and
/// again those on a node, as far as they were added together. So whoever goes through the nodes in program
/// order goes through memory in its order, too. It only grows.
class Order {
 public:
  [[nodiscard]] std::span<const Dependency> before(NodeId node) const {
    return {dependencies_.data() + begin_[index(node)], dependencies_.data() + begin_[index(node) + 1]};
  }
  /// The dependencies on `node`. Valid until the order grows.
  class After;
  [[nodiscard]] After after(NodeId node) const;
  /// How many nodes it covers.
  [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(first_block_.size()); }
  [[nodiscard]] std::size_t dependency_count() const { return dependencies_.size(); }
  [[nodiscard]] std::size_t bytes() const;

  /// Builders call these in program order: open_node() for a node, add() for each dependency of it,
  /// close_node(). In the end they call link() once for all nodes that were added; from then on after() knows
  /// of them.
  void open_node();
  void add(NodeId from, Reason reason, std::uint32_t subject);
  void close_node();
  void link();
  void reserve(std::size_t nodes, std::size_t dependencies);

 private:
  /// Dependencies on one node, in linked_: those of one call of link().
  struct Block {
    std::uint32_t begin = 0;
    std::uint32_t end = 0;
    std::uint32_t next = kNone;  ///< of the same node
  };
  void open_block(NodeId node, std::uint32_t place);

  std::vector<Dependency> dependencies_;
  std::vector<std::uint32_t> begin_{0};
  std::vector<Dependency> linked_;  ///< again, by `from`
  std::vector<Block> blocks_;
  std::vector<std::uint32_t> first_block_;  ///< by node; kNone: nothing depends on it
  std::uint32_t linked_nodes_ = 0;
};

/// The dependencies by which others come after a node, as a range; valid as long as the order is not changed.
class Order::After {
 public:
  /// A position in them.
  class Iterator {
   public:
    using value_type = Dependency;
    using difference_type = std::ptrdiff_t;
    Iterator(const Order& order, std::uint32_t block) : order_(&order) { enter(block); }
    const Dependency& operator*() const { return *at_; }
    Iterator& operator++() {
      if (++at_ == end_) enter(next_);
      return *this;
    }
    void operator++(int) { ++*this; }
    friend bool operator==(const Iterator& a, std::default_sentinel_t) { return a.at_ == nullptr; }

   private:
    void enter(std::uint32_t block) {
      at_ = nullptr;
      if (block == kNone) return;
      const Block& entered = order_->blocks_[block];
      at_ = order_->linked_.data() + entered.begin;
      end_ = order_->linked_.data() + entered.end;
      next_ = entered.next;
    }
    const Order* order_;
    const Dependency* at_ = nullptr;
    const Dependency* end_ = nullptr;
    std::uint32_t next_ = kNone;
  };
  After(const Order& order, NodeId node) : begin_(order, order.first_block_[index(node)]) {}
  [[nodiscard]] Iterator begin() const { return begin_; }
  [[nodiscard]] static std::default_sentinel_t end() { return {}; }

 private:
  Iterator begin_;
};

inline Order::After Order::after(NodeId node) const {
  return {*this, node};
}

/// The order of a whole network. The order keeps one reason for two nodes that come after one another because
/// of facts or places; `further`, where it is given, gets all others, in program order of `to`.
Order derive_order(const TaskNetwork& network, OrderRule rule = OrderRule::Epoch,
                   std::vector<Dependency>* further = nullptr);

/// Whether the dependency delays even a speculative run; of Data, until outputs exist, speculative ones
/// included. Pure nodes run on predicted facts, sensing ones only on real ones, and neither before an opaque
/// node has ended.
[[nodiscard]] inline bool holds_start(const TaskNetwork& network, const Dependency& dependency) {
  const ActionClass kind = network[dependency.to].kind;
  if (kind == ActionClass::Irreversible) return true;
  if (dependency.reason() == Reason::Fact) return kind == ActionClass::Sensing;
  return dependency.reason() != Reason::Condition;
}

/// The subject of a dependency as text: "arm_at(home)", "process:planner" ...
std::string subject_text(const TaskNetwork& network, const Dependency& dependency);

}  // namespace segue::task_network

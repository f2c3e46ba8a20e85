// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task_network/order.hpp>
#include <segue/task_network/run_result.hpp>
#include <segue/task_network/task_network.hpp>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace segue::task_network {

/// A period in which a node could not start or not commit, and the reason. World: a precondition that another
/// node had to make true. Resource, without a node: units that nobody could have (UnitLimits). Turn: program
/// order beside a node that may touch anything, or a free worker or copy of the world.
struct Wait {
  enum class Kind : std::uint8_t { Data, Condition, World, Resource, Turn };
  Kind kind = Kind::Data;
  NodeId node{kNone};   ///< the node whose end it waited for, if any
  std::string subject;  ///< the input, outcome, fact or resource
  TimePoint from;
  TimePoint until;
};
std::string_view to_string(Wait::Kind kind);
/// "world at(base) of drive"; `node` is the name of the node whose end it was, or empty.
std::string to_string(const Wait& wait, const std::string& node);

/// Finds out after a run what its nodes waited for. Whoever waited for a structural node is said to have
/// waited for what that one had waited for, unless it failed. All three arguments must outlive this.
class WaitFinder {
 public:
  WaitFinder(const TaskNetwork& network, const Order& order, const RunResult& result);

  /// The reasons in the order in which they ended, so the last one determined the start.
  [[nodiscard]] std::vector<Wait> of(NodeId node) const;
  /// Where the run that counts began before everything it depends on was certain: for how long it went on
  /// before that, which is the time by which speculation had it ready sooner.
  [[nodiscard]] std::optional<Duration> time_ahead(NodeId node) const;
  /// The chain of nodes that determined the makespan: from the last node back, each to the one it waited for
  /// last.
  [[nodiscard]] std::vector<NodeId> critical_chain() const;

 private:
  struct Use {
    TimePoint ended;
    NodeId node{};
  };
  void add_use(NodeId node, TimePoint ended);
  [[nodiscard]] std::vector<Wait> direct(NodeId node) const;
  [[nodiscard]] bool is_structural(NodeId node) const;
  [[nodiscard]] static const Use* last_before(const std::vector<Use>& uses, NodeId node, TimePoint started);
  [[nodiscard]] TimePoint met(const Dependency& dependency) const;
  void add_resource(std::vector<Wait>& waits, NodeId node, TimePoint ready) const;
  void add_limited(std::vector<Wait>& waits, NodeId node) const;
  void add_turn(std::vector<Wait>& waits, NodeId node, TimePoint ready) const;

  const TaskNetwork& network_;
  const Order& order_;
  const RunResult& result_;
  std::vector<Use> ends_;               ///< of all, by time
  std::vector<std::vector<Use>> uses_;  ///< by resource, by time
};

}  // namespace segue::task_network

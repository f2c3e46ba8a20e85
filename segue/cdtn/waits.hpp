// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/cdtn/order.hpp>
#include <segue/cdtn/run_result.hpp>
#include <segue/cdtn/task_network.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace segue::cdtn {

/// A stretch of time that a node could not start, or not count, and what it lacked. Turn: nothing but a place
/// among those that run: beside one that may touch anything, one after the other, or as many as there are
/// workers or copies of the world.
struct Wait {
  enum class Kind : std::uint8_t { Data, Condition, World, Resource, Turn };
  Kind kind = Kind::Data;
  NodeId node{kNone};   ///< whose end it was, if that of one node
  std::string subject;  ///< the input, outcome, fact or resource
  TimePoint from;
  TimePoint until;
};
std::string_view to_string(Wait::Kind kind);
/// "world at(base) of drive"; `node` is the name of whose end it was, or empty.
std::string to_string(const Wait& wait, const std::string& node);

/// What nodes of a run waited for. Refers to the three it is made of.
class WaitFinder {
 public:
  WaitFinder(const TaskNetwork& network, const Order& order, const RunResult& result);

  /// From the time at which everything else was there; the longest last.
  [[nodiscard]] std::vector<Wait> of(NodeId node) const;
  /// Whether its run that counts began before all was certain that it relies on.
  [[nodiscard]] bool was_speculative(NodeId node) const;

 private:
  struct Use {
    TimePoint ended;
    NodeId node{};
  };
  void add_use(NodeId node, TimePoint ended);
  [[nodiscard]] static const Use* last_before(const std::vector<Use>& uses, NodeId node, TimePoint started);
  [[nodiscard]] TimePoint met(const Dependency& dependency) const;
  void add_resource(std::vector<Wait>& waits, NodeId node, TimePoint ready) const;
  void add_turn(std::vector<Wait>& waits, NodeId node, TimePoint ready) const;

  const TaskNetwork& network_;
  const Order& order_;
  const RunResult& result_;
  std::vector<Use> ends_;               ///< of all, by time
  std::vector<std::vector<Use>> uses_;  ///< by resource, by time
};

/// Chain of nodes that a run was as long for: from the last node back, each time to whom it waited for last.
std::vector<NodeId> critical_chain(const RunResult& result, const WaitFinder& waits);

}  // namespace segue::cdtn

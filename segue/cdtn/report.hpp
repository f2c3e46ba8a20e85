// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/cdtn/critical_path.hpp>
#include <segue/cdtn/network.hpp>
#include <segue/cdtn/order.hpp>
#include <segue/cdtn/run_result.hpp>
#include <segue/type/value.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace segue::cdtn {

/// A stretch of time that a node could not start, or not count, and what it lacked.
struct Wait {
  enum class Kind : std::uint8_t { Data, Condition, World, Resource };
  Kind kind = Kind::Data;
  NodeId node{kNone};   ///< whose end it was, if that of one node
  std::string subject;  ///< the input, outcome, fact or resource
  TimePoint from;
  TimePoint until;
};
std::string_view to_string(Wait::Kind kind);

/// What the node waited for, from the time at which everything else was there; the longest last. World
/// includes its place among nodes that do not say what they touch.
std::vector<Wait> waits_of(const Network& network, const Order& order, const RunResult& result, NodeId node);

/// Chain of nodes that a run was as long for: from the last node back, each time to whom it waited for last.
std::vector<NodeId> critical_chain(const Network& network, const Order& order, const RunResult& result);

/// "done", "skipped" ...
std::string_view to_string(NodeStatus status);

/// What `segue mission run` prints as JSON.
struct RunSummary {
  Duration sequential{};
  Duration critical_path{};
  double engine_us_per_node = 0;
};
type::Value to_value(const Network& network, const Order& order, const RunResult& result,
                     const RunSummary& summary);

/// The run as an SVG drawing, by node and by resource: how long nodes waited and for what, what was run ahead
/// and what for nothing, the critical chain. Times in seconds.
std::string to_gantt(const Network& network, const Order& order, const RunResult& result);

/// The run in the JSON of Chrome's trace viewer, which Perfetto reads: a row for each resource and each lane
/// of nodes.
std::string to_trace(const Network& network, const Order& order, const RunResult& result);

}  // namespace segue::cdtn

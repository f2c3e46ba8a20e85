// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/error.hpp>
#include <segue/task_network/environment.hpp>
#include <segue/task_network/node_ids.hpp>
#include <segue/task_network/node_status.hpp>
#include <segue/task_network/versioned_world.hpp>

#include <cstdint>
#include <optional>
#include <vector>

namespace segue::task_network {

/// How a node of a run ended.
struct NodeResult {
  NodeStatus status = NodeStatus::NotReached;
  OutcomeId outcome = kSuccess;
  std::uint32_t attempts = 0;
  TimePoint started;  ///< of the run that counts
  TimePoint ended;
  TimePoint committed;          ///< from then on its effects count
  NodeId planned_after{kNone};  ///< the last node that had ended when it was appended to a growing network
};

/// A run of a pure or sensing node whose result was discarded.
struct WastedRun {
  NodeId node{};
  TimePoint started;
  TimePoint ended;
};

/// A node has waited for units of which nobody could have more (UnitLimits).
struct UnitWait {
  NodeId node{};
  ResourceId resource{};
  TimePoint from;
  TimePoint until;
};

/// Counts of a run.
struct RunStatistics {
  std::uint64_t starts = 0;
  std::uint64_t speculative = 0;  ///< runs that began before it was certain that they count
  std::uint64_t wasted = 0;       ///< of those, discarded
  std::uint64_t preempted = 0;    ///< of those, cancelled because a node that counts needed what they held
  std::uint64_t repeated = 0;     ///< further runs of nodes that had run before
  std::uint64_t looked_at = 0;    ///< waiting nodes, each time that units are given out or preempted for
};

/// An event of a node. Start: with all its resources. End: the run has ended and released them. Commit: its
/// effects count. Skip: it is off the path. Discard: the result of a run is discarded. Cancel: a run in
/// progress is not needed any more.
enum class LogKind : std::uint8_t { Start, End, Commit, Skip, Discard, Cancel };

/// An event of a node, and when it was.
struct LogEntry {
  TimePoint when;
  NodeId node{};
  std::uint32_t attempt = 0;
  LogKind kind = LogKind::Start;
};

using RunLog = std::vector<LogEntry>;

/// The result of a run, sequential or concurrent.
struct RunResult {
  std::optional<NodeId> failed;  ///< the lowest node that failed
  std::optional<Error> error;    ///< why
  bool stopped = false;          ///< on request
  VersionedWorld world;
  std::vector<std::uint32_t> units;  ///< of every resource, at the end
  Duration makespan{};
  Duration own_time{};  ///< differences of times up to this are the engine's own time, no waits
  std::vector<NodeResult> nodes;
  std::vector<std::shared_ptr<const type::Value>> outputs;  ///< of every node; null where it has none
  std::vector<WastedRun> wasted;
  std::vector<UnitWait> unit_waits;
  RunStatistics statistics;
  RunLog log;  ///< if asked for
  [[nodiscard]] bool done() const { return !failed && !stopped; }
};

}  // namespace segue::task_network

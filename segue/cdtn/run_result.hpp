// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/error.hpp>
#include <segue/cdtn/environment.hpp>
#include <segue/cdtn/ids.hpp>
#include <segue/cdtn/run_log.hpp>
#include <segue/cdtn/versioned_world.hpp>

#include <cstdint>
#include <optional>
#include <vector>

namespace segue::cdtn {

/// Where a node has got to at the end of a run.
enum class NodeStatus : std::uint8_t { NotReached, Done, Skipped, Failed, Preempted };

struct NodeResult {
  NodeStatus status = NodeStatus::NotReached;
  OutcomeId outcome = kSuccess;
  std::uint32_t attempts = 0;
  TimePoint started;  ///< the run that counts
  TimePoint ended;
  TimePoint committed;  ///< what it did counts from here
};

/// A run of a pure or sensing node that was thrown away.
struct WastedRun {
  NodeId node{};
  TimePoint started;
  TimePoint ended;
};

struct RunStatistics {
  std::uint64_t starts = 0;
  std::uint64_t speculative = 0;  ///< runs that began before it was certain that they are wanted
  std::uint64_t wasted = 0;       ///< of those, thrown away
  std::uint64_t preempted = 0;    ///< of those, for nodes that came before them and needed what they held
  std::uint64_t repeated = 0;     ///< runs of nodes that had run before
};

/// How a network ended, sequentially or concurrently.
struct RunResult {
  std::optional<NodeId> failed;  ///< the lowest node that did
  std::optional<Error> error;    ///< with it
  bool stopped = false;          ///< on request
  VersionedWorld world;
  std::vector<std::uint32_t> units;  ///< of every resource, at the end
  Duration makespan{};
  std::vector<NodeResult> nodes;
  std::vector<std::shared_ptr<const type::Value>> outputs;  ///< of every node; null where it has none
  std::vector<WastedRun> wasted;
  RunStatistics statistics;
  RunLog log;  ///< if asked for
  [[nodiscard]] bool done() const { return !failed && !stopped; }
};

}  // namespace segue::cdtn

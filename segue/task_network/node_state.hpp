// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/action_class.hpp>
#include <segue/task_network/node_ids.hpp>

#include <cstdint>

namespace segue::task_network {

/// Copying: waits for a copy of the world. Queued: for units. Ready: for a worker. Parked: has a result that
/// may not count yet.
enum class NodePhase : std::uint8_t { Waiting, Copying, Queued, Ready, Running, Parked, Done, Skipped };

/// How far a node has got in a concurrent run. Internal to ConcurrentEngine. Invariants:
///
/// - `commit_gate` counts the dependencies on account of which the node may not commit: of an irreversible
///   node, those of Reason::Resource whose `from` has not begun; of every node, those of other reasons whose
///   `from` has not passed. Set when the node is adopted, it only falls. A node commits or is refused only
///   when it is zero.
/// - `start_gate` counts the dependencies on account of which a pure or sensing node may not even run
///   speculatively: of Reason::Resource, while `from` has not begun; of Reason::Data, while `from` has not
///   announced outputs; and where gates_start(), while `from` has not passed. It is always zero for
///   irreversible nodes, which start when `commit_gate` is zero.
/// - Each dependency is counted once, when its `to` is adopted, and discounted once. `passed`, `announced`
/// and
///   `began` of its `from` record which of the events has happened, so that none is discounted twice.
/// - A counter that becomes zero puts the node into the engine's `work_`.
/// - A node passes once: when it has committed without failing, or when it was skipped and both gates are
///   zero.
/// - `active` holds from the start of a run to the end that the environment reports, `cancelled` or not; only
///   then its units and its worker are free again.
///
/// Every event touches the states of the nodes after it, so they are small; the times of a node are kept in
/// its NodeResult.
struct NodeState {
  std::uint32_t commit_gate = 0;
  std::uint32_t start_gate = 0;
  std::uint32_t attempt = 0;
  std::uint32_t version = 0;    ///< of its outputs; changes when they do
  std::uint32_t run_place = 0;  ///< in the engine's running_
  OutcomeId outcome = kSuccess;
  NodePhase phase = NodePhase::Waiting;
  ActionClass kind = ActionClass::Irreversible;
  // Copied from its record, as is `kind`.
  bool strict = false;           ///< also where all are
  bool claims = false;           ///< some units
  bool reads_world = false;      ///< and may do so again
  bool reads_beside = false;     ///< reads what is beside the network, and may do so again
  bool conditional : 1 = false;  ///< it has conditions
  bool observes : 1 = false;     ///< TaskNetwork::observes(), and it is not irreversible
  bool passed : 1 = false;
  bool announced : 1 = false;    ///< consumers know that there are outputs
  bool began : 1 = false;        ///< later users of its resources know that it has started
  bool cancelled : 1 = false;    ///< the run in progress is not wanted
  bool active : 1 = false;       ///< a run is in progress
  bool has_copy : 1 = false;     ///< of the world
  bool speculative : 1 = false;  ///< the last run began before it was certain that it counts
  bool failed : 1 = false;
  bool asked_world : 1 = false;
  bool lost : 1 = false;       ///< a race: however it ends, that is not a failure
  std::uint16_t unlikely = 0;  ///< as in its Rank: of the time when it began to wait, or was certain to count
};
static_assert(sizeof(NodeState) <= 32, "half a cache line");

}  // namespace segue::task_network

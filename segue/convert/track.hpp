// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/convert/path_conditions.hpp>
#include <segue/convert/symbol.hpp>
#include <segue/convert/weak_order.hpp>
#include <segue/mission/enclosing_scope.hpp>
#include <segue/mission/place.hpp>
#include <segue/mission/program.hpp>
#include <segue/task_network/resource.hpp>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// How far a mission has been unrolled. Internal.
namespace segue::convert {

/// A way to a state, with the error that occurred on it.
struct Arrival {
  BranchEdge when;
  bool aborted = false;  ///< the preceding state aborted, and the next one gets its error
  std::vector<Candidate> errors;
};
struct Exit {
  mission::Outcome outcome = 0;
  Arrival arrival;
};

/// All ways in which a state of the plan can end.
struct StateEnd {
  std::vector<Symbol> outputs;
  std::vector<Exit> exits;
};

struct ContainerRun;

/// The data with which a state is entered.
struct StateEntry {
  mission::StateIndex state = mission::kNoState;
  mission::StateIndex library = mission::kNoState;  ///< the outermost that it is the root of
  BranchEdge when;
  std::string path;
  std::string loops;            ///< as PlannedNode
  bool aborts_handled = false;  ///< an enclosing state handles its abort
  bool strict = false;          ///< it is declared strict, or an enclosing state
  std::vector<Symbol> inputs;
  std::vector<Candidate> errors;
  mission::EnclosingScopePtr around;  ///< what is declared around it
  std::shared_ptr<const std::vector<task_network::Claim>>
      memberships;                            ///< in the group locks of the containers around it; null: none
  std::shared_ptr<ContainerRun> container{};  ///< that it is in; null: the mission
};

/// The state whose defaults of outputs count.
inline mission::StateIndex shown_as(const StateEntry& entry) {
  return entry.library == mission::kNoState ? entry.state : entry.library;
}

/// One execution of a container in the plan.
struct ContainerExecution {
  explicit ContainerExecution(StateEntry given, std::size_t slot_count)
      : entry(std::move(given)),
        slots(slot_count),
        inside(entry.when),
        around(entry.around),
        memberships(entry.memberships),
        run(entry.container) {}
  StateEntry entry;
  Slots slots;
  std::shared_ptr<const WeakOrder> order;      ///< Hierarchy
  std::vector<std::vector<Arrival>> arrivals;  ///< Hierarchy: by child
  std::vector<Exit> exits;
  BranchEdge inside;                    ///< on which its states are entered
  BranchEdge joined;                    ///< Barrier: on which its decider is entered
  mission::EnclosingScopePtr around{};  ///< what is declared around its states
  std::shared_ptr<const std::vector<task_network::Claim>> memberships{};  ///< of its states
  std::shared_ptr<ContainerRun> run;  ///< itself, or that which a library or the mission is in
};

/// The place of a state of a barrier or of a race that is being planned, both for values beside the network
/// and for the network.
struct BranchPlace {
  std::shared_ptr<const mission::ParallelBranch> place{};  ///< null: the mission itself
  std::uint32_t in_network = task_network::kNone;          ///< of TaskNetwork::add_parallel_branch()
};

struct Track;

/// A preemptive container that is entered: the first of its states that ends preempts the others.
struct Race {
  std::shared_ptr<ContainerExecution> activation;
  std::vector<std::shared_ptr<Track>> tracks{};  ///< one for each state
  std::optional<std::size_t> first{};            ///< which of them ended first
};

/// The position up to which a container has been planned.
struct Frame {
  struct Loop {
    std::uint32_t head = 0;  ///< position in the order
    std::size_t iterations = 1;
    std::vector<std::vector<BranchEdge>>
        open{};  ///< by uncertain iteration: the edges on which it is entered
    /// Of an alternative: the ways back to the head. States that are planned as if the loop had ended must
    /// not take them, or the number of an iteration would depend on the progress of that plan.
    std::vector<Arrival> back{};
    /// The iteration in which it was checked last how far the plan is ahead of the run, and the number of
    /// nodes then.
    std::size_t looked = 1;
    std::uint32_t nodes = 0;
    std::optional<task_network::NodeId>
        far_behind{};  ///< no further iteration is planned before this node has ended
  };
  std::shared_ptr<ContainerExecution> activation;
  std::uint32_t place = 0;
  std::vector<Loop> loops;
  std::vector<std::shared_ptr<Track>> tracks;  ///< Barrier: one for each state except the decider
  std::shared_ptr<Race> race{};                ///< Preemptive
};

/// Where a track goes on if a loop does not end as expected.
struct Alternative {
  std::vector<Frame> frames;
  /// Of a barrier with such loops in its states: the edge on which what follows was planned, as if all of
  /// them had ended. Nothing: the frames are in the loop itself.
  std::optional<BranchEdge> behind{};
};

/// One sequence of states: the mission, or a state of a barrier or of a race. Where it was planned beyond
/// loops that are expected to end, it has alternatives, outermost first.
struct Track {
  std::vector<Frame> frames;
  BranchPlace branch{};
  std::vector<Alternative> alternatives{};
  std::optional<StateEntry> pending{};  ///< comes next, once its facts and resources are known
  std::optional<StateEnd> end{};
  bool races = false;
  std::vector<task_network::NodeId> open{};  ///< of a race: nodes that have not ended and may be on the path
  Track* around = nullptr;                   ///< of a race: that of an enclosing race
  [[nodiscard]] bool settled() const { return end && alternatives.empty(); }
};

/// The facts and resources of an action, once known.
struct Touch {
  std::optional<std::vector<std::size_t>> named_by{};  ///< the inputs that determine them, by port
  bool known = false;                                  ///< the same for all its nodes
  std::vector<task_network::Literal> preconditions{};
  std::vector<task_network::Literal> effects{};
  std::vector<task_network::Claim> claims{};
  mission::ObservedNeedsPtr observed{};
  /// How its nodes may end; and where aborts are handled.
  std::array<std::shared_ptr<const BranchEnds>, 2> ends{};
};

}  // namespace segue::convert

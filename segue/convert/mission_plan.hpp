// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/convert/opaque_subtrees.hpp>
#include <segue/convert/passed_on.hpp>
#include <segue/convert/path_index.hpp>
#include <segue/convert/symbol.hpp>
#include <segue/mission/action_runner.hpp>
#include <segue/mission/enclosing_scope.hpp>
#include <segue/mission/execution.hpp>
#include <segue/mission/place.hpp>
#include <segue/mission/program.hpp>
#include <segue/mission/units.hpp>
#include <segue/task_network/concurrent_engine.hpp>
#include <segue/task_network/run_result.hpp>

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Missions as task networks: state machines that are unrolled into nodes, which run concurrently.
namespace segue::convert {

/// Action: a leaf. OpaqueSubtree: a state with everything in it, run sequentially as one node. Join: says
/// whether one of several ways to a state was taken. Copy: forwards an input or a constant of a container
/// under a condition. Global: reads a global variable. Begin: of a container that declares
/// something; takes what it blocks. Change: computes what an action makes of a value of the world.
enum class Role : std::uint8_t { Action, OpaqueSubtree, Join, Copy, Global, Begin, Change };

/// Where a value comes from: the newest input that exists, or else `rest`.
struct ValueSource {
  struct Feed {
    std::uint32_t input = 0;  ///< of TaskNetwork::names
    Defaults defaults;
    std::uint64_t turn = 0;
  };
  std::vector<Feed> feeds;
  Defaults rest;
  std::uint64_t rest_turn = 0;
};
/// The value of an input of a node (of TaskNetwork::names), null where there is none.
using InputValues = std::function<const type::Value*(std::uint32_t input)>;
/// The newest of several values that is not null; null if all are.
[[nodiscard]] type::Value newest_value(std::span<const ValueSource> sources, const InputValues& inputs,
                                       const task_network::NameTable& names);

/// A way in which a sibling of a decider may have ended: with `outcome`, if the input says `reached`.
struct BranchEnd {
  std::uint32_t input = task_network::kNone;  ///< none: this is certain
  task_network::OutcomeId reached{};
  mission::Outcome outcome = 0;
  ValueSource error;
};
struct BranchSource {
  mission::StateIndex state = mission::kNoState;
  std::vector<BranchEnd> ends;
};

struct TouchedValues;

/// The meaning of a node of the network in the mission.
struct PlannedNode {
  Role role = Role::Action;
  mission::StateIndex state = mission::kNoState;
  mission::StateIndex shown_as =
      mission::kNoState;        ///< whose output defaults count: the outermost library that it is the root of
  BranchEdge when;              ///< it is on the path if this is
  std::uint32_t iteration = 0;  ///< how many nodes before it are of the same state
  std::string loops;            ///< as mission::Execution
  std::string_view path;        ///< in TaskNetwork::names; empty: the mission itself, or no state
  /// The sources of inputs, by port; of an OpaqueSubtree, then of all values in `touched`. A Copy has the
  /// forwarded values, of which the newest that is not null counts; a Change the value as it was, and then
  /// mission::sources_of_change().
  std::vector<ValueSource> inputs;
  ValueSource error_before;
  PassedOn passes_on = PassedOn::Nothing;
  ValueSource passed_on;                                  ///< by the execution before
  std::shared_ptr<const mission::ParallelBranch> branch;  ///< null: in no barrier
  std::vector<BranchSource> branches;                     ///< deciders
  std::vector<std::pair<std::uint32_t, task_network::OutcomeId>>
      joined;                           ///< Join: inputs and the values that they must have
  std::string variable;                 ///< Global: its name; Change: that of the value of the world
  std::string refused;                  ///< why the action can never begin
  mission::EnclosingScopePtr around{};  ///< OpaqueSubtree: what is declared around it
  std::shared_ptr<const TouchedValues> touched{};  ///< OpaqueSubtree: the values_within() it
  mission::ObservedNeedsPtr observed{};
};

/// Names of outputs in addition to those of ports.
inline constexpr std::string_view kOutcomeOutput = "#outcome";  ///< an OutcomeId, of nodes that branch
inline constexpr std::string_view kErrorOutput = "#error";      ///< only if it aborted
/// The output of a subtree that has not aborted, with the error of the last state in it, which is handled
/// there.
inline constexpr std::string_view kHandledErrorOutput = "#handled_error";
inline constexpr std::string_view kRecordOutput = "#record";  ///< NodeJournal::record_of()
inline constexpr std::string_view kValueOutput = "value";

class Unroller;
struct ContainerRun;

/// Which states have ended preemptive containers, and what an earlier run that is being resumed had recorded.
struct RaceRecord {
  /// The states that have ended their containers, now or in the earlier run.
  std::set<mission::Execution> firsts{};
  /// Whether recorded executions in that state have not begun yet, or the node is to end as recorded: the
  /// state does not lose before.
  std::function<bool(const mission::Execution& state)> awaits{};
  std::function<bool(task_network::NodeId node)> replays{};
  /// Whether the node was preempted in the earlier run: it is preempted again, and not left out.
  std::function<bool(task_network::NodeId node)> was_preempted{};
  /// Is told of each state that ends its container.
  std::function<void(const mission::Execution& state)> decided{};
};

/// How far a plan goes before anything is known. AsKnown: as runs need it, to the first decision or value
/// that it must wait for. EveryEnd: as far as AsKnown, also after aborts and preemptions that nothing
/// handles. Outline: to the end of the mission, with three rounds of each loop; actions of which it is not
/// known yet what they touch touch nothing.
enum class PlanScope : std::uint8_t { AsKnown, EveryEnd, Outline };

/// A mission that is being unrolled into a task network, which grows while it runs. Loops are unrolled ahead
/// of decisions, by more iterations the longer they run. Unexpected ends (aborts, other than expected
/// outcomes) that lead back into a loop are planned for once they have happened. For one thread.
class MissionPlan final : public task_network::Expansion {
 public:
  /// `inputs` by port of the root, null for its default; `facts` override the initial facts of the mission,
  /// `resources` its units. TypeMismatch for an input of another type, InvalidArgument for too many inputs
  /// and for malformed facts, NotFound for a resource that nothing uses.
  static Result<std::unique_ptr<MissionPlan>> create(std::shared_ptr<const mission::Program> program,
                                                     std::vector<type::Value> inputs = {},
                                                     const std::vector<mission::Fact>& facts = {},
                                                     PlanScope scope = PlanScope::AsKnown,
                                                     const mission::UnitCounts& resources = {});
  ~MissionPlan() override;

  void expand(task_network::TaskNetwork& network, std::size_t wanted) override;
  void ended(task_network::NodeId node, task_network::OutcomeId outcome, const type::Value* outputs) override;
  void failed(task_network::NodeId node) override;
  void skipped(task_network::NodeId node) override;
  [[nodiscard]] bool races() const override;
  [[nodiscard]] std::vector<task_network::NodeId> take_lost() override;
  [[nodiscard]] bool finished() const override;

  [[nodiscard]] task_network::TaskNetwork& network() { return network_; }
  [[nodiscard]] const task_network::TaskNetwork& network() const { return network_; }
  [[nodiscard]] const mission::Program& program() const { return *program_; }
  [[nodiscard]] const std::shared_ptr<const mission::Program>& shared_program() const { return program_; }
  [[nodiscard]] const PlannedNode& operator[](task_network::NodeId node) const { return nodes_[index(node)]; }
  /// The facts or values that must be known before it can plan further; empty if it had planned as much as
  /// was wanted.
  [[nodiscard]] const std::string& waits_for() const { return waits_for_; }
  [[nodiscard]] OpaqueSubtreeReason subtree_reason(mission::StateIndex state) const;
  /// Whether the ends that are known so far keep the node off the path.
  [[nodiscard]] bool off_path(task_network::NodeId node) const;
  /// The innermost container that the node is in, null for the mission itself; until the node is over.
  [[nodiscard]] std::shared_ptr<ContainerRun> container_of(task_network::NodeId node) const;
  /// How the container has ended, once all in it is over and that is certain.
  [[nodiscard]] std::optional<mission::Ending> end_of(const ContainerRun& container);
  /// Whether the ends that are known so far keep it off the path, or on the path.
  [[nodiscard]] bool off_path(const ContainerRun& container) const;
  [[nodiscard]] bool on_path(const ContainerRun& container) const;
  /// The tree of branches as it is now.
  [[nodiscard]] PathIndex path_index() const;
  /// The outcome of the state of that node.
  [[nodiscard]] mission::Outcome outcome(task_network::NodeId node, task_network::OutcomeId outcome) const;

  /// Sets the record of races; before the run.
  void set_race_record(RaceRecord record);
  [[nodiscard]] const RaceRecord& race_record() const;

  /// How the mission ended. Requires that the run has ended.
  [[nodiscard]] mission::Outcome final_outcome(const task_network::RunResult& result);
  [[nodiscard]] std::vector<type::Value> final_outputs();
  /// Why the mission aborted by a transition, or its last state aborted and that is handled; else empty.
  [[nodiscard]] std::string final_error();
  /// A plan of this mission with these inputs, of which nothing is planned yet. It goes on after every abort
  /// and preemption, too, up to the end of the mission, so it is for replays only.
  [[nodiscard]] std::unique_ptr<MissionPlan> from_the_beginning() const;

 private:
  friend class Unroller;
  explicit MissionPlan(std::shared_ptr<const mission::Program> program);

  std::shared_ptr<const mission::Program> program_;
  task_network::TaskNetwork network_;
  std::deque<PlannedNode> nodes_;
  std::string waits_for_;
  std::unique_ptr<Unroller> unroller_;
};

}  // namespace segue::convert

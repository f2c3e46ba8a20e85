// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/convert/container_run.hpp>
#include <segue/convert/mission_plan.hpp>
#include <segue/convert/track.hpp>
#include <segue/convert/world_flow.hpp>
#include <segue/mission/shared_units.hpp>

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace segue::convert {

/// Walks through a mission as the reference engine would, along all ways at once. States of a hierarchy are
/// taken in a weak topological order: all ways to a state are known before it becomes a node, and each state
/// gets one node for each iteration of the loops that contain it.
class Unroller {
 public:
  Unroller(MissionPlan& plan, std::vector<type::Value> inputs, PlanScope scope = PlanScope::AsKnown);
  Result<void> begin();
  /// Plans one node or a few; false if the plan must wait for a decision.
  bool step() { return step(main_); }
  void ended(task_network::NodeId node, task_network::OutcomeId outcome, const type::Value* outputs);
  void failed(task_network::NodeId node);
  void skipped(task_network::NodeId node);
  [[nodiscard]] std::vector<task_network::NodeId> take_lost();
  [[nodiscard]] bool finished() const { return main_.settled(); }
  [[nodiscard]] const StateEnd& end() const { return *main_.end; }
  PathConditions& paths() { return paths_; }
  [[nodiscard]] const std::vector<type::Value>& given() const { return given_; }
  [[nodiscard]] bool races() const { return !races_.empty(); }
  [[nodiscard]] const RaceRecord& race_record() const { return record_; }
  void set_race_record(RaceRecord record) { record_ = std::move(record); }
  [[nodiscard]] const OpaqueSubtreeReason& subtree_reason(mission::StateIndex state) const {
    return subtrees_[state];
  }
  /// The innermost container that the node is in, null for the mission itself; until the node is over.
  [[nodiscard]] std::shared_ptr<ContainerRun> container_of(task_network::NodeId node) const;
  /// The exit by which it has ended, once that is certain; null before.
  [[nodiscard]] const Exit* exit_of(const ContainerRun& container);
  /// The value of a symbol, once it is known for certain.
  [[nodiscard]] std::optional<type::Value> value_of(const Symbol& symbol);

 private:
  // Control (unroller.cpp)
  bool step(Track& track);
  bool step_within(Track& track);
  [[nodiscard]] std::optional<task_network::NodeId> first_open();
  [[nodiscard]] bool is_open(task_network::NodeId node);
  bool step_hierarchy(Track& track);
  bool step_barrier(Track& track);
  [[nodiscard]] StateEntry entry_of(const Frame& frame, mission::StateIndex child, BranchEdge when);
  bool visit(Track& track, mission::StateIndex state);
  bool enter_pending(Track& track);
  void enter(Track& track, StateEntry entry);
  void enter_container(Track& track, StateEntry entry);
  void enter_branches(Track& track, ContainerExecution& activation);
  [[nodiscard]] BranchPlace beside(const Track& track, std::uint64_t number, mission::StateIndex child);
  void leave(Track& track);
  void finish(Track& track, mission::StateIndex state, StateEnd end);
  void finish_in_hierarchy(Frame& frame, mission::StateIndex state, StateEnd end);
  std::vector<Candidate> errors_of(mission::StateIndex child, Exit& exit, const mission::NextStep& step);
  std::vector<Candidate> constant(std::string text, BranchEdge when);
  void finish_decider(Track& track, mission::StateIndex state, StateEnd end);
  void leave_off_path(Track& track);
  void join_barrier(Track& track, BranchEdge when);
  [[nodiscard]] std::vector<StateEnd> ends_beside(const Track& track) const;
  const std::vector<Arrival>& live_arrivals(std::vector<Arrival>& arrivals);
  [[nodiscard]] std::string path_of(const ContainerExecution& around, mission::StateIndex child) const;
  void find_varying();
  [[nodiscard]] bool strict_within(mission::StateIndex state) const;

  // Loops (unroller_loops.cpp)
  bool end_of_loop(Track& track);
  bool end_of_outlined_loop(Frame& frame);
  static bool plan_again(Frame& frame);
  void take_alternatives(Track& track);
  void plan_behind_loop(Track& track);
  bool plan_behind_barrier(Track& track);
  [[nodiscard]] std::optional<BranchEdge> all_ended(const Track& track);
  [[nodiscard]] bool goes_on(Alternative& alternative);
  [[nodiscard]] bool has_lapsed(Alternative& alternative);
  void wait_for_loop(const Frame& frame, std::string_view addition);
  void wait_for_unexpected(const Track& track);
  [[nodiscard]] bool leads_on(Frame& frame, std::uint32_t from);
  [[nodiscard]] bool is_too_far_ahead(Frame::Loop& loop);
  const std::shared_ptr<const WeakOrder>& order_of(mission::StateIndex hierarchy);
  [[nodiscard]] static std::string loops_around(const Frame& frame);

  // Races (unroller_races.cpp)
  [[nodiscard]] bool may_race(const StateEntry& entry);
  bool step_race(Track& track);
  void enter_race(Track& track, ContainerExecution& activation);
  void join_race(Track& track);
  void leave_race(ContainerExecution& activation, mission::StateIndex child, const StateEnd& end);
  [[nodiscard]] mission::Execution execution(const Race& race, std::size_t state) const;
  [[nodiscard]] std::optional<std::size_t> recorded_first(const Race& race) const;
  void find_first(Race& race);
  void decide(Race& race, std::size_t first);
  [[nodiscard]] bool replays(const Race& race, std::size_t first);
  [[nodiscard]] bool runs_for_certain(task_network::NodeId node);
  [[nodiscard]] bool has_ended(Track& track);
  void drop_ended(Track& track);
  [[nodiscard]] bool is_over(task_network::NodeId node) const {
    return over_.size() > index(node) && over_[index(node)];
  }
  void note_over(task_network::NodeId node);

  // Nodes (unroller_nodes.cpp), data (unroller_data.cpp)
  StateEnd add_action(const StateEntry& entry, const std::vector<StateEnd>* branches);
  std::vector<BranchSource> connect_branches(task_network::NodeSpec& spec, const StateEntry& decider,
                                             const std::vector<StateEnd>& ends);
  StateEnd add_subtree(const StateEntry& entry);
  BranchEdge meet(std::vector<BranchEdge> edges);
  BranchEdge add_join(BranchEdge around, std::vector<BranchEdge> edges);
  Symbol copied(std::span<const Symbol> values, BranchEdge when);
  Symbol read(const ContainerExecution& activation, const std::vector<std::uint32_t>& slots, BranchEdge at);
  task_network::NodeSpec& new_spec();
  PlannedNode begin_structural(Role role, BranchEdge when);
  task_network::NodeId append(task_network::NodeSpec& spec, PlannedNode node, std::string_view name);
  ValueSource connect(task_network::NodeSpec& spec, const Symbol& symbol, std::string_view name);
  std::optional<task_network::OutcomeId> expected_end(mission::StateIndex state);
  std::shared_ptr<const BranchEnds> branch_ends(const StateEntry& entry);
  StateEnd ends_of(const StateEntry& entry, task_network::NodeId node, const task_network::NodeSpec& spec);
  void take_passed_on(const StateEntry& entry, task_network::NodeSpec& spec, PlannedNode& planned);
  void store(ContainerExecution& activation, std::uint32_t slot, BranchEdge when, Symbol value);
  void take_outputs(ContainerExecution& activation, mission::StateIndex child, BranchEdge when,
                    std::vector<Symbol> outputs);
  std::vector<Symbol> inputs_of(ContainerExecution& activation, mission::StateIndex child, BranchEdge at);
  Default fallback(const mission::PortSource& supply, BranchEdge at);
  [[nodiscard]] bool is_ready(const StateEntry& entry);
  [[nodiscard]] bool is_in_turn(const StateEntry& entry);
  [[nodiscard]] std::optional<std::vector<type::Value>> naming_values(const StateEntry& entry);
  const std::vector<std::size_t>& naming_inputs(mission::StateIndex state);
  void declare(const StateEntry& entry, task_network::NodeSpec& spec, PlannedNode& planned);
  void declare_unknown(const StateEntry& entry, task_network::NodeSpec& spec);
  [[nodiscard]] Result<mission::Needs> needs_of(const StateEntry& entry);
  void look_up(const mission::Needs& needs, Touch& touch);

  // The values of the world (unroller_world.cpp)
  Symbol input_of(const StateEntry& entry, const mission::Action& action, std::size_t port);
  void wait_for_changes(const StateEntry& entry, const mission::Action& action, task_network::NodeSpec& spec);
  void wait_for_changes_of(const std::string& name, const StateEntry& entry, task_network::NodeSpec& spec);
  void change_world(const StateEntry& entry, const mission::Action& action, task_network::NodeId by,
                    const StateEnd& end);
  void connect_subtree_to_world(const StateEntry& entry, task_network::NodeSpec& spec, PlannedNode& planned);
  void change_world_by_subtree(const StateEntry& entry, task_network::NodeId subtree);

  // The declarations of containers, and their ends (unroller_containers.cpp)
  void begin_container(ContainerExecution& activation);
  void follow(ContainerExecution& activation);
  void put_in(const std::shared_ptr<ContainerRun>& container, task_network::NodeId node);
  void declare_begin(ContainerExecution& activation, task_network::NodeSpec& spec, PlannedNode& planned);
  void block(ContainerExecution& activation, task_network::NodeSpec& spec, const mission::Needs& needs);
  void lend(const mission::EnclosingScope::Held& held);
  [[nodiscard]] const mission::CompiledState& node(mission::StateIndex state) const {
    return plan_.program().node(state);
  }
  [[nodiscard]] const mission::Action& action(mission::StateIndex state) const {
    return plan_.program().mission().actions[node(state).action];
  }

  MissionPlan& plan_;
  const std::vector<type::Value> given_;
  const PlanScope scope_;
  PathConditions paths_;
  Track main_;
  BranchPlace branch_;          ///< of the nodes that are being planned
  std::uint64_t barriers_ = 0;  ///< executions that have been planned
  Track* racing_ = nullptr;     ///< of the nodes that are being planned
  RaceRecord record_;
  std::vector<std::weak_ptr<Race>> races_;  ///< that may not have been decided
  std::vector<task_network::NodeId> lost_;  ///< since take_lost()
  std::vector<bool> over_;                  ///< by node: it has ended, or was skipped
  std::unordered_map<std::uint32_t, std::shared_ptr<ContainerRun>> inside_;  ///< by node that is not over
  std::unordered_map<std::string, std::uint32_t> entered_;  ///< by path of a container: how often
  std::uint32_t over_before_ = 0;                           ///< all nodes before are over or off the path
  const std::vector<OpaqueSubtreeReason> subtrees_;         ///< by state
  std::unordered_map<mission::StateIndex, std::shared_ptr<const TouchedValues>> touched_;  ///< by subtree
  mission::SharedUnits shared_;
  std::vector<const Track*> before_;  ///< open ones of the states beside and before the one being planned
  std::vector<std::string> varying_;  ///< patterns of resources that are created or removed
  std::vector<std::string> blocked_within_;  ///< patterns of mission::resources_blocked_within()
  std::vector<std::shared_ptr<const type::Value>> outputs_;  ///< by node, of those that have ended
  std::unordered_map<mission::StateIndex, std::shared_ptr<const WeakOrder>> orders_;
  PassedOnFlow passed_on_;
  std::vector<std::uint32_t> copies_;  ///< by name, of TaskNetwork::names
  std::vector<Touch> touches_;         ///< by action
  WorldFlow world_;
  std::unordered_map<mission::StateIndex, decltype(Touch::named_by)> named_by_;  ///< of containers
  task_network::NodeSpec spec_;                                                  ///< of the current node
};

}  // namespace segue::convert

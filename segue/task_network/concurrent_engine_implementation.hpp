// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task_network/concurrent_engine.hpp>
#include <segue/task_network/engine_fault.hpp>
#include <segue/task_network/node_outcome.hpp>
#include <segue/task_network/node_state.hpp>
#include <segue/task_network/order_builder.hpp>
#include <segue/task_network/pause.hpp>
#include <segue/task_network/preemption.hpp>
#include <segue/task_network/ready_nodes.hpp>
#include <segue/task_network/resource_pool.hpp>
#include <segue/task_network/turns.hpp>
#include <segue/task_network/world_changes.hpp>
#include <segue/task_network/world_copies.hpp>

#include <atomic>
#include <string>
#include <unordered_map>
#include <vector>

namespace segue::task_network {

/// All state belongs to the thread that calls `run`; others only post to `events_`, set `stop_asked_`, and
/// ask `pause_` and `unit_waits_`. An event of a node puts the nodes that it concerns into `work_`.
class ConcurrentEngine::Implementation {
 public:
  Implementation(const TaskNetwork& network, const Order& order, Environment& environment,
                 ConcurrentEngineOptions options);
  Implementation(TaskNetwork& network, Expansion& plan, Environment& by, ConcurrentEngineOptions options);
  RunResult run();
  void stop();
  void pause(bool paused);
  void step();
  void limit(UnitLimits limits);
  [[nodiscard]] const Order& order() const { return order_; }
  [[nodiscard]] std::size_t bytes() const;

 private:
  using Phase = NodePhase;
  using State = NodeState;
  class RunContext;
  // Setting up and the loop (concurrent_engine.cpp).
  void adopt();
  void adopt_node(NodeId node);
  void count(State& state, const Dependency& dependency);
  [[nodiscard]] bool counts(const Dependency& dependency) const;
  bool expand();
  void loop();
  bool take_ends();
  void take_end(CompletionQueue::End& end);
  void work_off();
  void wake();
  void heed_stop();
  bool hold();
  [[nodiscard]] bool complete() const;
  [[nodiscard]] bool beyond(NodeId node) const { return index(node) >= limit_; }
  [[nodiscard]] bool needs_worker(NodeId node) const;
  [[nodiscard]] Rank rank(NodeId node) const;
  [[nodiscard]] bool gates_start(const Dependency& dependency) const;
  [[nodiscard]] bool irreversible(NodeId node) const { return at(node).kind == ActionClass::Irreversible; }
  State& at(NodeId node) { return states_[index(node)]; }
  [[nodiscard]] const State& at(NodeId node) const { return states_[index(node)]; }
  NodeResult& result_of(NodeId node) { return results_[index(node)]; }
  RunResult result();
  void log(NodeId node, LogKind kind);
  // Starting (concurrent_engine_start.cpp).
  void check(NodeId node);
  [[nodiscard]] bool waits_again(NodeId node);
  void try_start(NodeId node);
  [[nodiscard]] bool settled(NodeId node) const;
  bool sees_reality(NodeId node);
  [[nodiscard]] bool certain(NodeId node) const;
  [[nodiscard]] std::uint16_t unlikely(NodeId node) const;
  [[nodiscard]] bool may_run_ahead(NodeId node) const;
  bool queue_again(NodeId node);
  void make_ready(NodeId node);
  [[nodiscard]] bool takes_in_order(NodeId node) const;
  [[nodiscard]] std::optional<NodeId> risk_before(NodeId node) const;
  [[nodiscard]] ReportPtr refusal(NodeId node, const std::string& why);
  void refuse(NodeId node, const Error& error);
  bool admit(NodeId node);
  void claim(NodeId node);
  bool refuse_for_shortage(NodeId node);
  void dispatch(NodeId node);
  void launch(NodeId node);
  void note_unit_waits();
  void take_granted();
  void take_waiting();
  std::optional<NodeId> next_ready();
  [[nodiscard]] const Access* false_precondition(NodeId node) const;
  void note_what_is_read(NodeId node);
  void return_copy(NodeId node);
  void return_copies_of_producers(NodeId node);
  // Preempting speculative runs (concurrent_engine_preempt.cpp).
  void note_speculative(NodeId node, bool speculative);
  void note_preempted(NodeId node, bool preempted);
  void preempt_for_units(NodeId node);
  void preempt_for_waiting();
  void preempt(NodeId node);
  bool take_lost();
  void lose(NodeId node);
  bool give_up_lost();
  [[nodiscard]] bool collect_holders(NodeId node, const Claim& claim, std::vector<NodeId>& holders);
  // Ending (concurrent_engine_finish.cpp, concurrent_engine_undo.cpp).
  void park(NodeId node, ReportPtr report);
  void try_commit(NodeId node);
  [[nodiscard]] bool turn_has_come(NodeId node);
  [[nodiscard]] std::optional<NodeId> first_that_changes_world_of(NodeId node) const;
  bool world_is_known_to(NodeId node);
  void commit_lost(NodeId node);
  void commit_with_changes(NodeId node);
  [[nodiscard]] NodeOutcome judged(NodeId node) const;
  void commit(NodeId node, NodeOutcome outcome);
  void fail_node(NodeId node, Error error);
  void settle(NodeId node);
  void apply_effects(NodeId node, const NodeOutcome& outcome);
  void apply_undeclared(NodeId node, const Literal& literal);
  void pass(NodeId node);
  void notify(NodeId node);
  void arrive(const Dependency& dependency);
  void meet(const Dependency& dependency);
  void announce_outputs(NodeId node);
  void announce_start(NodeId node);
  void leave_groups(NodeId node);
  void advance_prefix();
  void skip(NodeId node);
  void skip_one(NodeId node);
  void abandon(NodeId node);
  void discard(NodeId node);
  void learn_effects(Report& report);
  void learn_units(const Report& report);
  void invalidate(NodeId node);
  void cancel_run(NodeId node);
  void truncate(NodeId node);
  void outputs_changed(NodeId node);
  void facts_changed(std::uint32_t access);
  void assumptions_changed(NodeId node);
  // Projected facts and worlds (projection.cpp).
  [[nodiscard]] bool projected(const Access& access) const;
  [[nodiscard]] bool assumed_on_path(NodeId writer, NodeId at) const;
  VersionedWorld projected_world(NodeId at);
  VersionedWorld real_world(NodeId at);
  VersionedWorld world_before(NodeId at);
  void catch_up_prefix_world();
  void add_effects(VersionedWorld& world, NodeId node) const;
  [[nodiscard]] std::uint32_t input_version(NodeId node, std::size_t place) const;
  [[nodiscard]] bool reads_are_valid(NodeId node) const;
  [[nodiscard]] bool inputs_are_valid(NodeId node) const;
  [[nodiscard]] bool world_is_valid(NodeId node);
  // Explaining a stall (stall.cpp).
  [[nodiscard]] Error stall_error() const;
  [[nodiscard]] std::string waits_for(NodeId node) const;
  const TaskNetwork& network_;
  const Order& order_;
  Environment& environment_;
  const ConcurrentEngineOptions options_;
  TaskNetwork* growing_ = nullptr;
  Expansion* expansion_ = nullptr;
  Order own_order_;
  std::unique_ptr<OrderBuilder> builder_;
  CompletionQueue events_;
  ResourcePool pool_;
  VersionedWorld world_;  ///< the facts; what is attached follows the order of the plan, in prefix_world_
  std::vector<State> states_;
  std::vector<NodeResult> results_;  ///< the times; the rest is added at the end
  std::vector<ReportPtr> reports_;
  std::vector<std::uint8_t> reads_;      ///< by access: 0 not read, else 2 + value
  std::vector<std::uint8_t> writes_;     ///< by access: 0 not yet, 1 nothing, else 2 + value
  std::vector<std::uint32_t> versions_;  ///< by input: that was used; 0: none
  std::uint32_t at_work_ = 0;  ///< running nodes that have a worker; counted if their number is limited
  std::vector<NodeId> work_;   ///< nodes to check
  std::vector<NodeId> running_, batch_, to_skip_, granted_;
  ReadyNodes ready_;
  WorldCopies copies_;
  PreemptibleUnits preemptible_;
  std::uint32_t preempted_workers_ = 0;  ///< held by cancelled runs that have not ended
  std::uint32_t passed_count_ = 0;
  NodeId last_done_{kNone};
  std::uint32_t prefix_ = 0;  ///< all nodes before have passed
  std::uint32_t safe_ = 0;    ///< no node before can fail any more
  Turns turns_;
  std::uint32_t limit_ = kNone;  ///< first node that is not reached any more
  std::optional<Error> error_;
  std::optional<NodeId> failed_;
  bool stopped_ = false;
  Pause pause_;
  UnitWaits unit_waits_;
  Patience patience_;
  VersionedWorld prefix_world_;  ///< at prefix_world_at_, in program order
  std::uint32_t prefix_world_at_ = 0;
  UndeclaredEffects undeclared_;
  std::unordered_map<std::uint32_t, WorldGuess> guesses_;  ///< by node
  std::vector<WastedRun> wasted_;
  RunStatistics statistics_;
  RunLog log_;
  std::atomic<bool> stop_asked_{false};
};

}  // namespace segue::task_network

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/cdtn/concurrent_engine.hpp>
#include <segue/cdtn/fault.hpp>
#include <segue/cdtn/node_outcome.hpp>
#include <segue/cdtn/resource_pool.hpp>

#include <atomic>
#include <map>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace segue::cdtn {

/// What Engine is made of. A node waits until two counts are zero: `commit_gate`, of what must have passed
/// before it may count, and `start_gate`, of what must have happened before a pure or sensing node may run at
/// all. A node passes when it has committed, or was skipped and everything before it has passed. Everything
/// is driven by such passages, nothing looks at the whole network.
class ConcurrentEngine::Implementation {
 public:
  Implementation(const TaskNetwork& network, const Order& order, Environment& environment,
                 ConcurrentEngineOptions options);
  Implementation(TaskNetwork& network, Expansion& expansion, Environment& environment,
                 ConcurrentEngineOptions options);
  RunResult run();
  void stop();
  [[nodiscard]] const Order& order() const { return order_; }
  [[nodiscard]] std::size_t bytes() const;

 private:
  /// Copying: waits for a copy of the world. Queued: for units. Ready: for a worker. Parked: has a result
  /// that may not count yet.
  enum class Phase : std::uint8_t { Waiting, Copying, Queued, Ready, Running, Parked, Done, Skipped };
  struct State {
    TimePoint started;
    TimePoint ended;
    TimePoint committed;
    std::uint32_t commit_gate = 0;
    std::uint32_t start_gate = 0;
    std::uint32_t attempt = 0;
    std::uint32_t version = 0;    ///< of its outputs; changes when they do
    std::uint32_t run_place = 0;  ///< in running_
    OutcomeId outcome = kSuccess;
    Phase phase = Phase::Waiting;
    bool passed : 1 = false;
    bool announced : 1 = false;  ///< consumers know that there are outputs
    bool began : 1 = false;      ///< those behind at a resource know that it has started
    bool cancelled : 1 = false;  ///< the run that goes on is not wanted
    bool active : 1 = false;     ///< a run goes on
    bool has_copy : 1 = false;
    bool speculative : 1 = false;
    bool failed : 1 = false;
    bool asked_world : 1 = false;
  };
  class RunContext;

  // Setting up and the loop (engine.cpp).
  void adopt();
  void adopt_node(NodeId node);
  void count(State& state, const Dependency& dependency);
  [[nodiscard]] bool counts(const Dependency& dependency) const;
  bool expand();
  void loop();
  bool take_ends();
  void work_off();
  void ask_to_stop();
  [[nodiscard]] bool complete() const;
  [[nodiscard]] bool beyond(NodeId node) const { return index(node) >= limit_; }
  [[nodiscard]] Rank rank(NodeId node) const;
  [[nodiscard]] bool gates_start(const Dependency& dependency) const;
  [[nodiscard]] bool irreversible(NodeId node) const {
    return network_[node].kind == NodeClass::Irreversible;
  }
  State& at(NodeId node) { return states_[index(node)]; }
  [[nodiscard]] const State& at(NodeId node) const { return states_[index(node)]; }
  RunResult result();
  void log(NodeId node, LogKind kind);
  // Starting (engine_start.cpp).
  void check(NodeId node);
  void try_start(NodeId node);
  [[nodiscard]] bool settled(NodeId node) const;
  [[nodiscard]] bool certain(NodeId node) const;
  [[nodiscard]] bool takes_in_order(NodeId node) const;
  [[nodiscard]] bool must_be_safe(NodeId node) const;
  void refuse(NodeId node, const Error& error);
  bool admit(NodeId node);
  void claim(NodeId node);
  void dispatch(NodeId node);
  void launch(NodeId node);
  void take_granted();
  void take_waiting();
  [[nodiscard]] const Access* false_precondition(NodeId node) const;
  void note_what_is_read(NodeId node);
  void return_copy(NodeId node);
  void return_copies_of_producers(NodeId node);

  // Giving back what runs ahead have (engine_recall.cpp).
  void note_speculative(NodeId node, bool speculative);
  void note_preempted(NodeId node, bool preempted);
  void preempt_for_units(NodeId node);
  void preempt_for_waiting();
  void preempt(NodeId node);
  [[nodiscard]] bool collect_speculative_holders(NodeId node, const Claim& claim,
                                                 std::vector<NodeId>& holders);

  // Ending (engine_finish.cpp).
  void end_run(CompletionQueue::End end);
  void park(NodeId node, ReportPtr report);
  void try_commit(NodeId node);
  void commit(NodeId node);
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
  void invalidate(NodeId node);
  void cancel_run(NodeId node);
  void truncate(NodeId node);
  void outputs_changed(NodeId node);
  void facts_changed(std::uint32_t access);
  void assumptions_changed(NodeId node);

  // What is true where (projection.cpp).
  [[nodiscard]] bool projected(const Access& access) const;
  [[nodiscard]] bool assumed_on_path(NodeId writer, NodeId at) const;
  VersionedWorld projected_world(NodeId at);
  void catch_up_prefix_world();
  void add_effects(VersionedWorld& world, NodeId node) const;
  [[nodiscard]] std::uint32_t input_version(NodeId node, std::size_t place) const;
  [[nodiscard]] bool reads_are_valid(NodeId node) const;
  [[nodiscard]] bool inputs_are_valid(NodeId node) const;
  [[nodiscard]] bool world_is_valid(NodeId node);

  // Where nobody can go on (stall.cpp).
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
  VersionedWorld world_;
  std::vector<State> states_;
  std::vector<ReportPtr> reports_;
  std::vector<std::uint8_t> reads_;      ///< by access: 0 not read, else 2 + value
  std::vector<std::uint8_t> writes_;     ///< by access: 0 not yet, 1 nothing, else 2 + value
  std::vector<std::uint32_t> versions_;  ///< by input: that was used; 0: none
  std::vector<NodeId> running_;
  std::vector<NodeId> work_;  ///< nodes to look at
  std::vector<NodeId> batch_;
  std::vector<NodeId> to_skip_;
  std::vector<NodeId> granted_;
  std::set<Rank> ready_;              ///< certain to be wanted
  std::set<Rank> ready_speculative_;  ///< others
  std::set<Rank> copying_;
  std::uint32_t copies_ = 0;
  std::vector<std::set<Rank>> speculative_;  ///< by resource: who runs ahead with units of it, or is about to
  std::vector<std::uint64_t> preempted_units_;  ///< by resource: units of runs that were cancelled and go on
  std::uint32_t preempted_workers_ = 0;         ///< likewise
  std::uint32_t passed_count_ = 0;
  std::uint32_t prefix_ = 0;        ///< everything before has passed
  std::uint32_t safe_ = 0;          ///< nothing before may fail any more
  std::set<std::uint32_t> strict_;  ///< nodes that wait for it
  std::uint32_t limit_ = kNone;     ///< nodes behind it are not reached: it has failed
  std::optional<Error> error_;
  std::optional<NodeId> failed_;
  bool stopped_ = false;
  TimePoint patience_ = TimePoint::max();  ///< until when cancelled runs must have ended
  VersionedWorld prefix_world_;            ///< at prefix_world_at_, in program order
  std::uint32_t prefix_world_at_ = 0;
  std::unordered_map<std::uint32_t, std::vector<std::pair<NodeId, bool>>>
      undeclared_;                                                   ///< by fact: of opaque nodes
  std::unordered_map<std::uint32_t, std::vector<Literal>> guesses_;  ///< by node
  std::vector<WastedRun> wasted_;
  RunStatistics statistics_;
  RunLog log_;
  std::atomic<bool> stop_asked_{false};
};

}  // namespace segue::cdtn

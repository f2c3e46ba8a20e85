// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/virtual_clock.hpp>
#include <segue/mission/shared_units.hpp>
#include <segue/mission_engine/activation.hpp>
#include <segue/mission_engine/breakpoints.hpp>
#include <segue/mission_engine/engine.hpp>
#include <segue/mission_engine/mailbox.hpp>
#include <segue/mission_engine/retry_watch.hpp>

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <queue>
#include <string>
#include <utility>
#include <vector>

namespace segue::mission::detail {

/// The implementation of Engine. Every execution of a state is an activation that points to that of its
/// parent; nothing recurses, so nesting costs memory only. Activations that can go on are in `ready_`; each
/// runs until it has to wait, or for kTurn steps.
///
/// Invariants: an activation is in `ready_` or in `held_`, or waits (Phase::Wait) for its children, units, a
/// timer or a completer, or waits for its siblings (Phase::Done). `open_calls_` counts the leaves that a
/// completer or the journal will end. A timer, a completion or a postponed leaf belongs to one use of an
/// activation: where the generation has changed since, it is ignored. Everything here belongs to the engine's
/// thread; other threads reach it only through the mailbox.
class EngineCore {
 public:
  EngineCore(std::shared_ptr<const Program> program, std::vector<std::shared_ptr<ActionRunner>> runners,
             World world, Units units, EngineOptions options);
  Engine::Progress run();

  /// Which hierarchies stop before their next child: none, all, or those that have a mark and all outside of
  /// them. Breakpoints stop in any mode, and lead to Hold.
  enum class Mode : std::uint8_t { Run, Hold, Marked };
  /// Releases what is held: in Hold for one child each, in Marked until it is back at a mark.
  void release(Mode mode);
  void mark_held(bool outside);
  Result<void> step_back();
  using Path = std::vector<StateIndex>;  ///< a state and those around it, the outermost first
  Result<void> go_on_at(const Path& path);
  [[nodiscard]] std::vector<std::string> held_at() const;
  [[nodiscard]] type::Value values_of(const Path& path);
  [[nodiscard]] std::string path(const Activation& activation) const;

  std::shared_ptr<const Program> program;
  std::vector<std::shared_ptr<ActionRunner>> runners;  ///< by action
  std::shared_ptr<FactObserver> observer{};  ///< runners compare observed facts with it; null: none are
  EngineOptions options;
  Globals globals;
  World world;
  Units units;
  History history;
  std::shared_ptr<Mailbox> mailbox = std::make_shared<Mailbox>();
  MissionResult result;
  bool ended = false;
  std::uint64_t executions = 0;
  bool at_rest = false;  ///< all that could go on is held
  Breakpoints breakpoints;
  std::vector<std::pair<std::size_t, type::Value>> given_inputs;
  std::vector<StateIndex> start_path;  ///< states to enter, the next one last

 private:
  class LeafCall;
  // engine_core.cpp: scheduling, time, messages
  void begin();
  void go_on(Activation* activation);
  Activation* step(Activation& activation);
  bool wait();
  void read_messages();
  bool fire_timers();
  void abandon_late();
  void complete(Activation& activation, const Ending& ending);
  void preempt(Activation& root);
  [[nodiscard]] TimePoint now() const { return options.clock->now(); }
  // engine_states.cpp: the semantics of each kind of state
  Activation* enter(Activation& activation);
  Activation* enter_leaf(Activation& activation);
  Activation* enter_library(Activation& activation);
  Activation* begin_container(Activation& container);
  Activation* begin_branches(Activation& concurrency);
  Activation* proceed(Activation& hierarchy);
  Activation* leave(Activation& activation, Outcome outcome);
  Activation* finish(Activation& activation);
  Activation* begin_leaf(Activation& leaf);
  void apply_effects(Activation& leaf);
  Activation* child_of_hierarchy(Activation& hierarchy, Activation& child);
  Activation* child_of_concurrency(Activation& concurrency, Activation& child);
  Activation* join(Activation& concurrency);
  Activation* follow(Activation& concurrency, const Activation& child);
  Ending call(Activation& leaf, bool& under_way);
  Ending execute(Activation& leaf, bool& under_way);
  void check(Activation& leaf, const Ending& ending);
  [[nodiscard]] std::uint64_t iteration_of(const Activation& activation) const;
  void tell_begin(const Activation& leaf);
  void tell_around(const Activation& state);
  void tell_end(Activation& activation);
  void first_step(Activation& hierarchy);
  // engine_units.cpp: what an action needs before it begins
  Activation* ask(Activation& activation);
  bool look_up(Activation& activation);
  bool take_units(Activation& leaf, Units::Limits limits);
  void give_units_back(Activation& leaf);
  void keep_blocked(Activation& container);
  [[nodiscard]] static std::span<const EnclosingScope::Held> lent_by(const Activation& container);
  void hold_units_again(Activation& container, UnitsUsed& before);
  bool ask_again();
  bool give_up_waiting();
  [[nodiscard]] bool is_overtaking(const Activation& leaf);
  [[nodiscard]] bool is_in_turn(const Activation& leaf, bool to_the_end = false);
  [[nodiscard]] bool only_lacks_held(const Activation& leaf);
  [[nodiscard]] bool may_use_more(const Activation& state, StateIndex user);
  [[nodiscard]] Units::Limits limits_for(const Activation& leaf) const;
  // engine_robot_units.cpp: units that the robot does not show
  void watch_units();
  void note_unit_wait(Activation& leaf);
  void end_unit_wait(Activation& leaf);
  [[nodiscard]] bool awaits_robot() const;
  [[nodiscard]] bool lacks_lost_robot(const Activation& leaf) const;
  // engine_data.cpp: activations and the data flow between them
  Activation* make(StateIndex state, Activation* parent);
  void free(Activation& activation);
  void free_children(Activation& container);
  void fill_inputs(Activation& child, Activation& container);
  void fill_world_inputs(Activation& leaf);
  [[nodiscard]] WorldValues new_values(const Action& action, const Activation& leaf) const;
  void set_up(Activation& container);
  void set(Activation& container, std::uint32_t slot, type::Value value);
  void take_outputs(Activation& container, const Activation& child);
  void give_outputs(Activation& container);
  [[nodiscard]] type::Value fallback(const PortSource& supply);
  static const Slot* newest(const PortSource& supply, const Activation& container);
  void warn(const Activation& activation, const std::string& message) const;
  // engine_journal.cpp: recording and replaying
  Ending call_with_journal(Activation& leaf, bool& under_way);
  Ending begin_with_journal(Activation& leaf, bool& under_way);
  bool replay_end(Activation& leaf);
  bool replay_next();
  bool begin_postponed();
  void record_begin(const Activation& leaf);
  void record_end(const Activation& leaf);
  // engine_control.cpp: holding, stepping and stepping back
  [[nodiscard]] bool holds(Activation& hierarchy);
  [[nodiscard]] bool holds_branch(Activation& branch);
  [[nodiscard]] bool breaks_at(StateIndex state, const Activation& holder) const;
  void let_go(Activation& activation);
  void tell_held();
  [[nodiscard]] std::string next_path(const Activation& holder) const;
  void remember(Activation& hierarchy, Activation& child);
  Result<Activation*> out_to_something_done(Activation& hierarchy);
  void undo_at(Activation& hierarchy);
  void hold(Activation& hierarchy);
  void restore(Activation& hierarchy, UndoRecord& record);
  void undo_leaf(Activation& around, StateIndex state, const UndoRecord& done);
  void undo_all(Activation& kept);
  void forget(Activation& kept);
  // engine_position.cpp: where the mission is, what is there, and going on elsewhere
  [[nodiscard]] std::pair<Activation*, std::size_t> innermost(const Path& path, std::size_t depth) const;
  [[nodiscard]] std::vector<type::Value> next_inputs(const CompiledState& node, const Activation& container);
  [[nodiscard]] bool take_jump(Activation& hierarchy);
  void forget_done(Activation& hierarchy);
  std::deque<Activation> pool_;
  std::vector<Activation*> free_;
  std::deque<Activation*> ready_;
  std::vector<Activation*> held_;
  bool held_changed_ = false;  ///< since that was told
  std::optional<Jump> jump_;
  std::priority_queue<Timer> timers_;
  using Waiting = std::pair<Activation*, std::uint64_t>;  ///< and its generation
  std::map<std::size_t, Waiting> replaying_;              ///< by position in the journal
  std::deque<Waiting> postponed_;  ///< not in the journal; begin once its entries are replayed
  std::size_t replayed_count_ = 0;
  std::vector<std::pair<TimePoint, Timer>> late_;  ///< preempted, with the time at which they are abandoned
  std::shared_ptr<Iterations> iterations_;
  std::vector<bool> touches_;         ///< by action: it has facts or resources
  std::vector<bool> changes_values_;  ///< by action: of the world
  SharedUnits shared_;
  RetryWatch retries_;
  std::vector<Waiting> asking_;  ///< leaves that wait for units, the first one longest
  RobotUnits robot_units_;
  std::vector<std::pair<std::uint32_t, Slot>> replaced_;  ///< by the child that ends, for its undo record
  const EnclosingScopePtr around_root_;
  Activation* root_ = nullptr;
  Mode mode_ = Mode::Run;
  VirtualClock* virtual_clock_ = nullptr;
  std::uint64_t stamp_ = 0;
  std::uint64_t timer_order_ = 0;
  std::uint64_t open_calls_ = 0;
  bool backward_ = false;
  bool undoing_ = false;  ///< a step back waits for an action
  std::vector<std::function<void()>> postponed_tasks_;
};

}  // namespace segue::mission::detail

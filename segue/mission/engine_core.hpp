// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/virtual_clock.hpp>
#include <segue/mission/activation.hpp>
#include <segue/mission/engine.hpp>
#include <segue/mission/mailbox.hpp>

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <queue>
#include <string>
#include <utility>
#include <vector>

namespace segue::mission::detail {

/// The engine behind Engine. Executions are activations that point to the one around; nothing recurses, so
/// depth costs memory only. What can go on is in `ready_`; each goes on until it waits, or for a while.
class EngineCore {
 public:
  EngineCore(std::shared_ptr<const Program> program, std::vector<std::shared_ptr<ActionRunner>> runners,
             World world, EngineOptions options);

  Engine::Progress run();

  enum class Mode : std::uint8_t { Run, Hold, Marked, Until };
  /// Lets go what is held: in Hold for one child each, in Marked until it is back at a mark, in Until the
  /// path.
  void release(Mode mode);
  void mark_held(bool outside);
  Result<void> step_back();
  [[nodiscard]] std::vector<std::string> held_at() const;
  [[nodiscard]] std::string path(const Activation& activation) const;

  std::shared_ptr<const Program> program;
  std::vector<std::shared_ptr<ActionRunner>> runners;  ///< by action
  EngineOptions options;
  Globals globals;
  World world;
  History history;
  std::shared_ptr<Mailbox> mailbox = std::make_shared<Mailbox>();
  MissionResult result;
  bool ended = false;
  std::uint64_t executions = 0;
  std::string until;  ///< Mode::Until
  std::vector<std::pair<std::size_t, type::Value>> given_inputs;
  std::vector<StateIndex> start_path;  ///< states to enter, the next one last

 private:
  class LeafCall;
  struct Timer {
    TimePoint when;
    std::uint64_t order = 0;
    Activation* activation = nullptr;
    std::uint64_t generation = 0;
    bool operator<(const Timer& other) const {
      return when == other.when ? order > other.order : when > other.when;
    }
  };

  // engine_core.cpp: who goes on, time, news
  void begin();
  void go_on(Activation* activation);
  Activation* step(Activation& activation);
  bool wait();
  void read_news();
  bool fire_timers();
  void abandon_late();
  void complete(Activation& activation, Ending ending);
  void preempt(Activation& root);
  [[nodiscard]] TimePoint now() const { return options.clock->now(); }

  // engine_states.cpp: the rules of every kind of state
  Activation* enter(Activation& activation);
  Activation* enter_leaf(Activation& activation);
  Activation* enter_library(Activation& activation);
  Activation* enter_concurrency(Activation& activation);
  Activation* proceed(Activation& hierarchy);
  Activation* leave(Activation& activation, Outcome outcome);
  Activation* finish(Activation& activation);
  bool look_at_facts(Activation& leaf);
  void bring_about(Activation& leaf);
  Activation* child_of_hierarchy(Activation& hierarchy, Activation& child);
  Activation* child_of_concurrency(Activation& concurrency, Activation& child);
  Activation* join(Activation& concurrency);
  Activation* follow(Activation& concurrency, const Activation& child);
  Ending call(Activation& leaf, bool& under_way);
  Ending execute(Activation& leaf, bool& under_way);
  void check(Activation& leaf, const Ending& ending);
  void first_step(Activation& hierarchy);

  // engine_data.cpp: activations and what flows between them
  Activation* make(StateIndex state, Activation* parent);
  void free(Activation& activation);
  void free_children(Activation& container);
  void fill_inputs(Activation& child, Activation& container);
  void set_up(Activation& container);
  void set(Activation& container, std::uint32_t slot, type::Value value);
  void take_outputs(Activation& container, const Activation& child);
  void give_outputs(Activation& container);
  [[nodiscard]] type::Value fallback(const Supply& supply);
  static const Slot* newest(const Supply& supply, const Activation& container);
  void warn(const Activation& activation, const std::string& message) const;

  // engine_journal.cpp: what outlives the run
  Ending call_recorded(Activation& leaf, bool& under_way);
  Ending begin_recorded(Activation& leaf, bool& under_way);
  bool recall(Activation& leaf);
  bool recall_next();
  bool begin_postponed();
  [[nodiscard]] std::optional<Ending> settled(const Activation& leaf) const;
  void record_begin(const Activation& leaf);
  void record_end(const Activation& leaf);

  // engine_control.cpp: holding and going back
  [[nodiscard]] bool holds(Activation& hierarchy);
  void let_go(Activation& activation);
  [[nodiscard]] std::string next_path(const Activation& hierarchy) const;
  void remember(Activation& hierarchy, Activation& child);
  Result<Activation*> out_to_something_done(Activation& hierarchy);
  void undo_at(Activation& hierarchy);
  void hold(Activation& hierarchy);
  void restore(Activation& hierarchy, Trail& trail);
  void undo_leaf(Activation& around, StateIndex state, const Trail& done);
  void undo_all(Activation& kept);
  void forget(Activation& kept);

  std::deque<Activation> pool_;
  std::vector<Activation*> free_;
  std::deque<Activation*> ready_;
  std::vector<Activation*> held_;
  std::priority_queue<Timer> timers_;
  using Waiting = std::pair<Activation*, std::uint64_t>;  ///< and its generation
  std::map<std::size_t, Waiting> recalled_;               ///< by place in the journal
  std::deque<Waiting> postponed_;                         ///< not in the journal, begun after what is
  std::size_t recalled_count_ = 0;
  std::vector<std::pair<TimePoint, Timer>> late_;  ///< preempted, and when they are given up
  std::shared_ptr<Iterations> iterations_;
  std::vector<bool> touches_;  ///< by action: it names facts, or resources by its inputs
  std::vector<std::pair<std::uint32_t, Slot>> replaced_;  ///< by the child that ends, for its trail
  Activation* root_ = nullptr;
  Mode mode_ = Mode::Run;
  VirtualClock* virtual_clock_ = nullptr;
  std::uint64_t stamp_ = 0;
  std::uint64_t timer_order_ = 0;
  std::uint64_t open_calls_ = 0;
  bool backward_ = false;
};

}  // namespace segue::mission::detail

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/mission/enclosing_scope.hpp>
#include <segue/mission/globals.hpp>
#include <segue/mission/program.hpp>
#include <segue/mission/unit_keeper.hpp>
#include <segue/mission/units.hpp>
#include <segue/mission/world.hpp>
#include <segue/mission_engine/history.hpp>
#include <segue/mission_engine/run_journal.hpp>
#include <segue/mission_engine/runners.hpp>

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace segue::mission {

namespace detail {
class EngineCore;
}  // namespace detail

/// How often each state has begun, by StateIndex. Shared by engines that run parts of one mission.
/// Counters only: they order nothing between threads.
using Iterations = std::vector<std::atomic<std::uint32_t>>;

/// One state of a mission with everything in it, which an engine runs on its own.
struct MissionPart {
  StateIndex state = 0;
  StateIndex shown_as = 0;  ///< the outermost library that it is the root of; else the state itself
  std::string path;         ///< of the parent state; "" if that is the mission
  std::vector<type::Value> inputs;
  std::string error_before;  ///< with which the preceding state aborted
  Globals globals;           ///< shared with the creator
  std::shared_ptr<Iterations> iterations;
  WorldView world;      ///< when it begins
  WorldValues values;   ///< when it begins
  Units::Counts units;  ///< when it begins
  EnclosingScopePtr around{};
};

struct EngineOptions {
  /// A VirtualClock jumps to the next end of an action as soon as nothing else can go on.
  Clock* clock = &RealClock::instance();
  bool history = true;
  /// Keeps the data needed to step back: inputs, and the values that executions replaced.
  bool backward = false;
  /// How long a preempted action may take to end, in real time; then it counts as aborted and its end is
  /// ignored.
  Duration preemption_grace = std::chrono::seconds(10);
  /// Facts that hold at the beginning, or do not, in place of what the mission declares.
  std::vector<Fact> facts{};
  /// How many units of some resources there are, in place of what the mission declares.
  UnitCounts resources{};
  /// The data attached to the world, for actions that read the world.
  AttachedData world_data{};
  /// Receives warnings, such as that an input is not of the declared type, or that a state aborts again and
  /// again (RetryWatch). On the engine's thread.
  std::function<void(std::string)> warn;
  /// Called for every action and container that begins or ends, but for those whose ends a journal supplies
  /// and while a step back is carried out. An end only: of an action that a resumed run skips, and of an
  /// action or a container that may not begin, since a precondition does not hold or units lack.
  StateObserver observe{};
  /// A step back takes the changes of an execution back. Where the run has a journal and is stopped, those of
  /// what was under way are not told, since it begins again when the run is resumed.
  UnitObserver observe_units{};
  /// Records the run, and supplies the ends of an earlier run that is resumed. Not with `backward`, nor for a
  /// part.
  std::shared_ptr<RunJournal> journal{};
  /// Called on the thread of run() when other states are held than before while what runs beside them goes
  /// on, as a watch does. Null: run() tells only once all that could go on is held.
  std::function<void()> on_held{};
  /// Runs only this part; by default the whole mission, with its own globals and iterations.
  std::optional<MissionPart> part{};
};

/// How a mission ended. Outputs are in the order in which the root declares them.
struct MissionResult {
  Outcome outcome = 0;
  std::string outcome_name;
  std::string error;  ///< why it aborted
  std::vector<type::Value> outputs;
};

/// Runs a mission sequentially as it is written, which is the reference semantics (that of RAFCON; see
/// docs/missions.md). All functions are called by one thread, except where they say otherwise. An engine runs
/// once.
class Engine {
 public:
  /// NotFound if an action has no runner or nothing uses a given resource, InvalidArgument if a given fact is
  /// malformed, Unsupported for a journal together with `backward` or a part.
  static Result<std::unique_ptr<Engine>> create(std::shared_ptr<const Program> program,
                                                const Runners& runners, EngineOptions options = {});
  ~Engine();
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  /// Sets an input of the root in place of its default. NotFound, TypeMismatch. Before the first run().
  Result<void> set_input(std::string_view name, type::Value value);
  /// Begins at that state ("fetch/grasp") instead of at the start states of its parents. NotFound. Before the
  /// first run().
  Result<void> start_at(std::string_view path);

  enum class Progress { Ended, Held };
  /// Runs until the mission has ended, or until everything that could go on is held (by a pause or a step).
  /// Blocks, without a deadline, while actions run.
  Progress run();
  /// Requires that run() has answered Ended.
  [[nodiscard]] const MissionResult& result() const;

  /// Makes hierarchies stop before their next state. Running actions continue. From any thread.
  void pause();
  /// Preempts everything that runs; preemption handlers still execute. Breakpoints end. From any thread.
  void stop();
  /// Makes the thread of run() call `task` between two steps of states; it may call all functions of the
  /// engine but run(). From any thread.
  void post(std::function<void()> task);
  /// Blocks, after run() has returned Held, until one of the above has been requested, which the next run()
  /// heeds.
  void wait_for_message();

  /// Sets the states, by their paths, before which the mission stops as by a pause, in place of those set
  /// before. Where several states begin together, only the named ones stop before they begin. States that
  /// have begun according to a journal are passed. NotFound, InvalidArgument. Also while stepping.
  Result<void> set_breakpoints(const std::vector<std::string>& paths);

  /// How far the held states go on, called after run() has returned Held, before its first call, or while
  /// something runs beside them: to the end;
  /// one state, entering it if it has states; one state with everything in it; to the end of the hierarchy;
  /// until `path` is the next state.
  void resume();
  void step_into();
  void step_over();
  void step_out();
  void run_to(std::string path);
  /// Goes on at that state, with the inputs that it would have now. The innermost running hierarchy around it
  /// preempts what it has under way; states that run beside that hierarchy go on. Where the mission is held,
  /// it stays held, before that state. Steps back end here. NotFound, InvalidArgument; Unsupported with a
  /// journal, or where only a container of concurrent states can begin that state; InvalidState while it is
  /// being preempted.
  Result<void> go_on_at(std::string_view path);
  /// Undoes the action before the point at which the mission is held: calls its backward execution, blocks
  /// until that has ended, and restores all data. Concurrent states are undone together. InvalidState if the
  /// mission is not held or `backward` was not set, NotFound at the beginning and within a branch of
  /// concurrent states that has done nothing.
  Result<void> step_back();
  /// The paths of the states that come next where the mission is held.
  [[nodiscard]] std::vector<std::string> held_at() const;
  /// Whether all that could go on is held: steps back are possible.
  [[nodiscard]] bool is_at_rest() const;
  /// The values at the ports of a state, cut to a size that can be shown: {"when" ("running"; "ended": beside
  /// others that run; "next": as they would be if it began now; "": its container does not run), "inputs",
  /// "outputs" (what it, or its last execution there, has given): lists of {"name", "type", "text" (JSON),
  /// "cut" (where it is not all)}}. NotFound.
  [[nodiscard]] Result<type::Value> values_of(std::string_view path);

  [[nodiscard]] const Program& program() const;
  [[nodiscard]] const History& history() const;
  [[nodiscard]] Globals& globals();
  /// The facts that hold: the initial ones, changed by the actions that ended as expected.
  [[nodiscard]] const World& world() const;
  /// The remaining units of resources.
  [[nodiscard]] const Units& units() const;
  /// How many executions of states have begun, actions and containers alike.
  [[nodiscard]] std::uint64_t executions() const;

 private:
  explicit Engine(std::unique_ptr<detail::EngineCore> core);
  std::unique_ptr<detail::EngineCore> core_;
};

}  // namespace segue::mission

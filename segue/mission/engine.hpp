// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/mission/action_runner.hpp>
#include <segue/mission/globals.hpp>
#include <segue/mission/history.hpp>
#include <segue/mission/program.hpp>
#include <segue/mission/run_journal.hpp>
#include <segue/mission/world.hpp>

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
using Iterations = std::vector<std::atomic<std::uint32_t>>;

/// One state of a mission, and all in it, that runs by itself.
struct MissionPart {
  StateIndex state = 0;
  std::string path;  ///< of the state around; "" where that is the mission
  std::vector<type::Value> inputs;
  std::string error_before;  ///< what the state before it aborted with
  Globals globals;           ///< shared with whoever made this
  std::shared_ptr<Iterations> iterations;
  World::Facts world;  ///< what holds when it begins
};

struct EngineOptions {
  /// With a VirtualClock time jumps to the next end of an action as soon as nothing else is to be done.
  Clock* clock = &RealClock::instance();
  bool history = true;
  /// Keeps what is needed to step back: inputs, and the values that executions replaced.
  bool backward = false;
  /// How long an action that is preempted may go on, in real time; then it counts as aborted and is
  /// forgotten.
  Duration preemption_grace = std::chrono::seconds(10);
  /// Hold at the beginning, or do not, whatever the mission says of its world.
  std::vector<Fact> facts{};
  /// Told what is odd but no failure, such as an input of another type than declared.
  std::function<void(std::string)> warn;
  /// Called for every action that begins and every one that ends, but for those whose ends a journal supplies
  /// and while a step back is carried out. An action that a resumed run skips has an end only.
  ActionObserver observe{};
  /// Where it writes what it does, and finds what an earlier run has done. Not with `backward`, nor for a
  /// part.
  std::shared_ptr<RunJournal> journal{};
  /// Runs only that; by default the whole mission, with globals and iterations of its own.
  std::optional<MissionPart> part{};
};

/// How a mission ended. Outputs are in the order of the root's declaration.
struct MissionResult {
  Outcome outcome = 0;
  std::string outcome_name;
  std::string error;  ///< why it aborted
  std::vector<type::Value> outputs;
};

/// Runs a mission as it is written: the reference semantics, which is RAFCON's (docs/missions.md). One thread
/// owns an engine and calls everything but what says otherwise. One run each.
class Engine {
 public:
  /// NotFound where an action has no runner, InvalidArgument where a given fact is none, Unsupported for a
  /// journal of what is to be stepped back.
  static Result<std::unique_ptr<Engine>> create(std::shared_ptr<const Program> program,
                                                const Runners& runners, EngineOptions options = {});
  ~Engine();
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  /// Inputs of the root, by name, in place of their defaults. NotFound, TypeMismatch. Before the first run().
  Result<void> set_input(std::string_view name, type::Value value);
  /// Begins at that state ("fetch/grasp") instead of the start of the hierarchies around it. NotFound. Before
  /// the first run().
  Result<void> start_at(std::string_view path);

  enum class Progress { Ended, Held };
  /// Goes on until the mission has ended, or all that could go on is held (paused or stepped). Blocks.
  Progress run();
  /// Requires that run() has answered Ended.
  [[nodiscard]] const MissionResult& result() const;

  /// From any thread: hierarchies stop before their next state. Actions under way go on.
  void pause();
  /// From any thread: preempts everything under way; preemption handlers still run.
  void stop();

  /// What run() does next, once it has answered Held (or before its first call): everything; one state,
  /// entering it where it has states; one state with all that is in it; the rest of the hierarchy; until this
  /// state comes next.
  void resume();
  void step_into();
  void step_over();
  void step_out();
  void run_to(std::string path);
  /// Undoes the last action before where the mission is held, and blocks until that has ended. Its backward
  /// execution is called, then all data is as it was before it. States side by side are undone together.
  /// InvalidState where nothing is held or `backward` was not asked for, NotFound at the beginning.
  Result<void> step_back();
  /// The states that come next where it is held, as paths, in their order.
  [[nodiscard]] std::vector<std::string> held_at() const;

  [[nodiscard]] const Program& program() const;
  [[nodiscard]] const History& history() const;
  [[nodiscard]] Globals& globals();
  /// The facts that hold: what the mission began with, and what came about by actions that ended as expected.
  [[nodiscard]] const World& world() const;
  /// Executions of states that have begun, actions and containers.
  [[nodiscard]] std::uint64_t executions() const;

 private:
  explicit Engine(std::unique_ptr<detail::EngineCore> core);
  std::unique_ptr<detail::EngineCore> core_;
};

}  // namespace segue::mission

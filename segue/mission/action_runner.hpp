// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/pending_changes.hpp>
#include <segue/base/result.hpp>
#include <segue/mission/outcome.hpp>
#include <segue/mission/state_index.hpp>
#include <segue/mission/world_view.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace segue::mission {

struct Action;
class Globals;
struct ObservedNeeds;
class Program;

/// How an execution ended; `error` says why it aborted. `pending`: what an execution that may be discarded
/// has changed beside its outputs and the global variables; null: nothing. `memory`: the number that the
/// runner has given to what the execution leaves to the next one of its state (ActionCall::memory); 0: what
/// it began with.
struct Ending {
  Outcome outcome = 0;
  std::string error;
  std::shared_ptr<PendingChanges> pending{};
  std::uint64_t memory = 0;
};

/// An action or a container that begins or has ended, as reported to an observer. A container begins with the
/// first event of a state in it, and ends once it is left; the mission itself is not reported. The texts are
/// valid during the call.
struct StateEvent {
  enum class Kind : std::uint8_t { Began, Ended };
  Kind kind = Kind::Began;
  std::string_view path;        ///< of its state: "fetch/grasp"
  std::uint64_t iteration = 0;  ///< how often the state had begun before
  std::string_view outcome{};   ///< Ended
  std::string_view error{};     ///< Ended: why it aborted; else empty
  bool is_container = false;
};
/// Called on the engine's thread; must not block.
using StateObserver = std::function<void(const StateEvent&)>;

/// How a sibling of a decider ended.
struct BranchResult {
  StateIndex state = kNoState;
  Outcome outcome = 0;
  std::string error;
};

/// Ends an execution that continued after start(). Copies end the same execution; only the first call counts,
/// and none does after the engine has abandoned the execution or was destroyed. May be called by any thread.
using Completer = std::function<void(Ending ending, std::vector<type::Value> outputs)>;

/// One execution of an action, as its runner sees it. Valid until start() returns; for the engine's thread
/// only.
class ActionCall {
 public:
  virtual ~ActionCall() = default;
  ActionCall() = default;
  ActionCall(const ActionCall&) = delete;
  ActionCall& operator=(const ActionCall&) = delete;

  [[nodiscard]] virtual StateIndex state() const = 0;
  [[nodiscard]] virtual const Program& program() const = 0;
  [[nodiscard]] virtual std::string path() const = 0;
  /// In the order in which the action declares them.
  [[nodiscard]] virtual std::span<const type::Value> inputs() const = 0;
  /// To be written by the runner; initially the defaults.
  [[nodiscard]] virtual std::span<type::Value> outputs() = 0;
  /// In an execution that may be discarded, changes are kept aside until it counts.
  [[nodiscard]] virtual Globals& globals() const = 0;
  /// Whether the execution may be discarded, since the action is pure or sensing and the run concurrent: what
  /// it changes must be kept aside (Ending::pending).
  [[nodiscard]] virtual bool may_be_discarded() const { return false; }
  /// Where executions of the state may run ahead of each other: the number of what the one before has left
  /// (Ending::memory), 0 if there is nothing. Nothing: what the last one has left that counts.
  [[nodiscard]] virtual std::optional<std::uint64_t> memory() const { return std::nullopt; }
  /// The facts that hold, and what is attached to them. For a pure action in a concurrent run those that are
  /// predicted; the action is repeated if they were predicted wrongly. An action that names the data which it
  /// reads gets these, and no facts. InvalidState if the action does not declare `reads_world`.
  [[nodiscard]] Result<WorldView> world() const;
  /// The error with which the preceding state aborted; empty if it did not.
  [[nodiscard]] virtual const std::string& error_before() const = 0;
  /// For deciders: how the siblings ended, in their order.
  [[nodiscard]] virtual std::span<const BranchResult> branches() const = 0;
  /// How often this state had begun before.
  [[nodiscard]] virtual std::uint64_t iteration() const = 0;
  /// How far an earlier run had got with this execution (recorder()), which goes on from there; null: it
  /// begins.
  [[nodiscard]] virtual const type::Value& progress() const;
  /// Records how far the execution has got, for a run that is resumed: from any thread; on disk when it
  /// returns. Null where the run has no journal.
  [[nodiscard]] virtual std::function<void(const type::Value&)> recorder() const { return {}; }
  /// The observed facts among those that it needs; null: none, or the run is not observed.
  [[nodiscard]] virtual const ObservedNeeds* observed() const { return nullptr; }
  /// Whether the action is to be undone; one that cannot be undone simply ends.
  [[nodiscard]] virtual bool backward() const = 0;

  /// Lets the execution continue after start() has returned nothing. `preempt` is called at most once, when
  /// the execution must end early: on the engine's thread, or where an observed fact ends it on another one.
  /// It must not block.
  virtual Completer defer(std::function<void()> preempt) = 0;
  /// Ends the execution after `duration` on the engine's clock, or immediately when it is preempted.
  virtual void end_after(Duration duration, Ending ending) = 0;

  [[nodiscard]] const Action& action() const;
  /// The input of that name; null if there is none.
  [[nodiscard]] const type::Value& input(std::string_view name) const;
  /// False if there is no such output.
  bool set_output(std::string_view name, type::Value value);
  /// The value with those of inputs in place of the texts "{input}" in it, at any depth.
  [[nodiscard]] type::Value filled(const type::Value& value) const;
  /// The name of a controller with the values of inputs in place of "{input}" in it.
  [[nodiscard]] Result<std::string> controller(std::string name) const;
  /// The number of the outcome of that name; nothing if there is none.
  [[nodiscard]] std::optional<Outcome> outcome(std::string_view name) const;

 private:
  [[nodiscard]] virtual WorldView look_at_world() const = 0;
};

/// Executes actions of one kind.
class ActionRunner {
 public:
  virtual ~ActionRunner() = default;
  /// Whether the runner has everything that executions need. Called before a run; NotFound refuses that run.
  [[nodiscard]] virtual Result<void> check() const { return {}; }
  /// Whether an execution that an earlier run had begun can go on from its recorded progress
  /// (ActionCall::recorder); takes charge of what the execution has left behind. Called before a run that is
  /// resumed; Unsupported where it cannot.
  virtual Result<void> go_on(const Action& action, const type::Value& progress);
  /// Begins an execution, or goes on with it. Either returns its ending, or arranges for it by
  /// ActionCall::defer or ActionCall::end_after and returns nothing. Called on the engine's thread; must not
  /// block.
  virtual std::optional<Ending> start(ActionCall& call) = 0;
};

}  // namespace segue::mission

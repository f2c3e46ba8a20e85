// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/mission/globals.hpp>
#include <segue/mission/program.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace segue::mission {

/// How an execution ended. `error` says why, where it aborted.
struct Ending {
  Outcome outcome = 0;
  std::string error;
};

/// An action that begins or has ended, for whoever follows a run. The texts are valid during the call.
struct ActionEvent {
  enum class Kind : std::uint8_t { Began, Ended };
  Kind kind = Kind::Began;
  std::string_view path;        ///< of its state: "fetch/grasp"
  std::uint64_t iteration = 0;  ///< how often the state had begun before
  std::string_view outcome{};   ///< Ended
  std::string_view error{};     ///< Ended: why it aborted; else empty
};
/// Called on the engine's thread; must not block.
using ActionObserver = std::function<void(const ActionEvent&)>;

/// How a state beside a decider ended.
struct BranchResult {
  StateIndex state = kNoState;
  Outcome outcome = 0;
  std::string error;
};

/// Ends an execution that went on after start(). Copies end the same one; only the first call counts, and
/// none does once the engine has given the execution up or is gone. From any thread.
using Completer = std::function<void(Ending ending, std::vector<type::Value> outputs)>;

/// One execution of an action, as its runner sees it. Valid until start() returns; only in the engine's
/// thread. What it is made of is up to the engine.
class Call {
 public:
  virtual ~Call() = default;
  Call() = default;
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

  [[nodiscard]] virtual StateIndex state() const = 0;
  [[nodiscard]] virtual const Program& program() const = 0;
  [[nodiscard]] virtual std::string path() const = 0;
  /// In the order of the action's declaration.
  [[nodiscard]] virtual std::span<const type::Value> inputs() const = 0;
  /// To be written; they hold the defaults.
  [[nodiscard]] virtual std::span<type::Value> outputs() = 0;
  [[nodiscard]] virtual Globals& globals() const = 0;
  /// What the state before this one aborted with; empty where it did not.
  [[nodiscard]] virtual const std::string& error_before() const = 0;
  /// For deciders: how the other states ended, in their order.
  [[nodiscard]] virtual std::span<const BranchResult> branches() const = 0;
  /// How often this state has begun before.
  [[nodiscard]] virtual std::uint64_t iteration() const = 0;
  /// To be undone rather than done: an action that cannot just ends.
  [[nodiscard]] virtual bool backward() const = 0;

  /// Keeps the execution going after start() has returned nothing. `preempt` is called once, in the engine's
  /// thread, when it is to end early; it must not block.
  virtual Completer defer(std::function<void()> preempt) = 0;
  /// Ends the execution by itself after `duration` of the engine's clock; at once when it is preempted.
  virtual void end_after(Duration duration, Ending ending) = 0;

  [[nodiscard]] const Action& action() const;
  /// By name; null where there is no such input.
  [[nodiscard]] const type::Value& input(std::string_view name) const;
  /// False where there is no such output.
  bool set_output(std::string_view name, type::Value value);
  /// The number of the outcome; nothing where there is none of that name.
  [[nodiscard]] std::optional<Outcome> outcome(std::string_view name) const;
};

/// What executes actions of one kind.
class ActionRunner {
 public:
  virtual ~ActionRunner() = default;
  /// Begins an execution, and either ends it too, or arranges its end by Call::defer or Call::end_after and
  /// returns nothing. Called in the engine's thread; must not block.
  virtual std::optional<Ending> start(Call& call) = 0;
};

/// An action as a C++ function that is done when it returns. What it throws becomes an abort.
using Function = std::function<Ending(Call&)>;

/// Who executes which action. Callbacks by name; simulated actions and decisions are built in.
class Runners {
 public:
  Runners();
  ~Runners();

  void add(const std::string& callback, Function function);
  void add(const std::string& callback, std::shared_ptr<ActionRunner> runner);
  /// For all actions with a script, such as a ScriptRunner.
  void set_scripts(std::shared_ptr<ActionRunner> runner);
  /// Simulates every action but deciders by what is expected of it, whatever it says under `run`.
  void simulate_all();

  /// The runner of each action of the mission; NotFound for the first that has none.
  [[nodiscard]] Result<std::vector<std::shared_ptr<ActionRunner>>> assign(const Mission& mission) const;

 private:
  [[nodiscard]] Result<std::shared_ptr<ActionRunner>> runner_of(const Action& action) const;

  std::unordered_map<std::string, std::shared_ptr<ActionRunner>> callbacks_;
  std::shared_ptr<ActionRunner> scripts_;
  std::shared_ptr<ActionRunner> simulation_;
  std::shared_ptr<ActionRunner> expectation_;
  std::shared_ptr<ActionRunner> decisions_;
  bool simulate_all_ = false;
};

}  // namespace segue::mission

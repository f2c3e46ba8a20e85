// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/diagnostic.hpp>
#include <segue/base/result.hpp>
#include <segue/model/component.hpp>
#include <segue/model/network.hpp>
#include <segue/model/transition.hpp>
#include <segue/model/validate.hpp>
#include <segue/task/task.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

/// Where tasks live, and how they are made, moved through their life cycle and looked at.
namespace segue::host {

/// A task as it is seen from outside.
struct TaskReport {
  model::TaskId id;
  model::ComponentName component;
  model::DeploymentKey process;
  int pid = 0;
  TaskState state = TaskState::PreOperational;
  std::string state_name;  ///< the named sub-state
  std::string error;
  bool stand_in = false;
  Activity activity;
  task::Timing timing;
};

/// Samples through one connection since it was made.
struct ConnectionReport {
  model::Connection connection;
  std::uint64_t written = 0;
  std::uint64_t read = 0;
  std::uint64_t dropped = 0;
};

/// Something happened to a task by itself.
struct TaskEvent {
  model::TaskId task;
  TaskState state = TaskState::Exception;
  std::string message;
};

/// Something happened to a deployment process.
struct ProcessEvent {
  model::DeploymentKey process;
  std::string message;
  bool gone = false;  ///< it and its tasks are not there any more
};

using HostEvent = std::variant<TaskEvent, ProcessEvent>;

/// How one action of a batch has ended.
struct Completed {
  std::size_t index = 0;  ///< its place in the batch
  Result<void> outcome;
  std::optional<Duration> took{};  ///< from its own begin to its end, where that was measured
};

/// Gets the actions of a batch that have ended since the last call, at least one. Called from any thread,
/// also before the function that begins the batch returns, and by several threads at the same time. Must not
/// block; may begin other batches.
using Completion = std::function<void(std::vector<Completed>)>;

/// Calls `begin` with a Completion, waits until it has got `count` actions, and returns their outcomes in the
/// order of their indices.
std::vector<Result<void>> wait_for_outcomes(std::size_t count, const std::function<void(Completion)>& begin);

/// Reads the samples of an output port for a person or a tool. Destroying it removes the connection.
class PortReader {
 public:
  virtual ~PortReader() = default;
  /// What came since the last call, oldest first, at most `limit`. Does not block.
  virtual std::vector<type::Value> read(std::size_t limit) = 0;
  [[nodiscard]] virtual std::string type_name() const = 0;
};

/// Carries out actions on tasks and tells what they do. All functions may be called from any thread.
class TaskHost {
 public:
  virtual ~TaskHost() = default;

  /// How closely a network must be validated before it may run here: stand-ins take any component and port.
  [[nodiscard]] virtual model::Depth validation_depth() const { return model::Depth::Full; }
  /// Whether tasks of this component can be made here; NotFound with what to install where not.
  virtual Result<void> can_make(const model::ComponentName& component) const;
  /// What else keeps a network from running here: tasks on computers that cannot be reached, links that
  /// cannot carry a connection.
  [[nodiscard]] virtual Diagnostics check(const model::Network& network) const;
  /// Which network is about to be made. Told once before the first action of a transition; may prepare, does
  /// not change what runs.
  virtual void expect(const model::Network& target);
  /// Everything that can be made before `target` is committed has been made. Does what later actions would
  /// have to do besides, as far as it does not change what runs; what fails here is found by those actions.
  virtual void get_ready(const model::Network& target);
  /// Whether a task that moves to another process can be made there beside the incarnation that still runs.
  [[nodiscard]] virtual bool side_by_side() const { return false; }
  /// All actions of the transition are done: new incarnations become the ones that plain ids mean; tasks that
  /// it removes, and incarnations that were replaced, are forgotten (destroyed, their processes stay), kept
  /// tasks that it redefines get their new definitions.
  virtual void conclude(const model::Transition& transition);
  /// The transition is given up: plain ids mean the incarnations that stood before again. New ones remain,
  /// under their full ids, until they are removed.
  virtual void withdraw();

  /// Carries out one action in the caller's thread. The result of CallOperation is dropped; call() returns
  /// it. DeadlineExceeded: the true state must be observed.
  virtual Result<void> perform(const model::Action& action, TimePoint deadline) = 0;

  /// Begins to carry out actions that do not depend on each other, at the same time, and returns without
  /// waiting for hooks. A failure does not keep the others from being carried out. Each action is reported
  /// exactly once: what ends quickly together is reported together, what ends while others still run without
  /// waiting for them, and what has not ended shortly after `deadline` as DeadlineExceeded; it may still be
  /// at work.
  virtual void begin_all(std::vector<model::Action> actions, TimePoint deadline, Completion completed);
  /// The same, and waits; outcomes in the order of `actions`.
  std::vector<Result<void>> perform_all(std::span<const model::Action> actions, TimePoint deadline);

  /// What truly runs, as a network: every configured or named task with its true state, properties and
  /// placement, every connection, every deployment.
  [[nodiscard]] virtual model::Network observe() const = 0;

  [[nodiscard]] virtual std::vector<TaskReport> tasks() const = 0;
  [[nodiscard]] virtual std::vector<ConnectionReport> connections() const = 0;
  /// The interface of a task as it is now, dynamic ports included.
  virtual Result<model::ComponentModel> describe(const model::TaskId& task) const = 0;
  virtual Result<type::Value> properties(const model::TaskId& task) const = 0;
  virtual Result<void> set_property(const model::TaskId& task, std::string_view path,
                                    const type::Value& value, TimePoint deadline) = 0;
  virtual Result<type::Value> call(const model::TaskId& task, std::string_view operation,
                                   const type::Value& arguments, TimePoint deadline) = 0;
  virtual Result<std::unique_ptr<PortReader>> open_reader(const model::PortRef& port, std::size_t buffer) = 0;

  /// Called from any thread when a task changes its state, or a process goes, other than by an action; must
  /// not block. No call is under way any more when set_listener returns.
  using Listener = std::function<void(const HostEvent&)>;
  virtual void set_listener(Listener listener) = 0;
};

}  // namespace segue::host

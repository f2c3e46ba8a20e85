// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/model/network.hpp>

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace segue::model {

/// In the order of the paper's sequential execution (ours, transitions.md point 2). HandOver is not in
/// the paper: the task that it takes the state from is cleaned up after it. CallOperation stands where the
/// request puts it.
enum class ActionKind : std::uint8_t {
  Recover,
  Stop,
  Disconnect,
  Cleanup,
  Undeploy,
  Deploy,
  ApplyConfig,
  Configure,
  Connect,
  HandOver,
  Start,
  CallOperation
};
inline constexpr std::array<std::string_view, 12> kActionKindNames = {
    "recover",      "stop",      "disconnect", "cleanup",   "undeploy", "deploy",
    "apply_config", "configure", "connect",    "hand_over", "start",    "call_operation"};
inline std::string_view to_string(ActionKind kind) {
  return kActionKindNames.at(static_cast<std::size_t>(kind));
}

/// The phase of a transactional execution that an action belongs to.
enum class Phase : std::uint8_t { Prepare, Commit, Retire };
inline constexpr std::array<std::string_view, 3> kPhaseNames = {"prepare", "commit", "retire"};
inline std::string_view to_string(Phase phase) {
  return kPhaseNames.at(static_cast<std::size_t>(phase));
}

/// Recover, Stop, Cleanup, Configure, Start.
struct TaskAction {
  TaskId task;
  friend bool operator==(const TaskAction&, const TaskAction&) = default;
};
/// Disconnect, Connect.
struct ConnectionAction {
  Connection connection;
  /// The connection carries samples as soon as it is made and until it is disconnected, whenever the
  /// transition commits: what another computer sends begins and ends there.
  bool at_once = false;
  friend bool operator==(const ConnectionAction&, const ConnectionAction&) = default;
};
/// Deploy (all attributes count), Undeploy (the key counts). The list of tasks is empty: apply_config places
/// tasks.
struct DeploymentAction {
  Deployment deployment;
  bool kill = false;  ///< Undeploy: the process is killed without stopping its tasks
  friend bool operator==(const DeploymentAction&, const DeploymentAction&) = default;
};
/// ApplyConfig: the whole definition of the task as the target network has it, and where it lives. Creates
/// the task in its process where it does not exist yet (or has another component).
struct ConfigAction {
  Task definition;
  DeploymentKey process;
  std::string name;  ///< inside the process
  friend bool operator==(const ConfigAction&, const ConfigAction&) = default;
};
/// HandOver: the state of `from`, which is stopped, becomes that of `to`, which is configured and does not
/// run. With one id: from the old incarnation to the new one.
struct HandOverAction {
  TaskId from;
  TaskId to;
  friend bool operator==(const HandOverAction&, const HandOverAction&) = default;
};
/// The call of an operation, as a step of a transition.
struct CallAction {
  TaskId task;
  std::string operation;
  type::Value arguments{type::ValueMap{}};
  friend bool operator==(const CallAction&, const CallAction&) = default;
};

/// One step of a transition.
struct Action {
  int id = 0;  ///< from 1, in the order of the list
  ActionKind kind = ActionKind::Recover;
  std::variant<TaskAction, ConnectionAction, DeploymentAction, ConfigAction, CallAction, HandOverAction> what;
  Phase phase = Phase::Commit;
  std::vector<int> after;  ///< ids of actions that must be done before; always of earlier actions in the list

  /// The task of a TaskAction, ConfigAction or CallAction, and the receiver of a HandOverAction; nullptr for
  /// the others.
  [[nodiscard]] const TaskId* task() const;
  /// "stop area_explorer", "connect a.out -> b.in": for messages and events.
  [[nodiscard]] std::string label() const;
  friend bool operator==(const Action&, const Action&) = default;
};

enum class Order : std::uint8_t { Seamless, Paper };
inline constexpr std::array<std::string_view, 2> kOrderNames = {"seamless", "paper"};
inline std::string_view to_string(Order order) {
  return kOrderNames.at(static_cast<std::size_t>(order));
}
/// Empty: Seamless. InvalidArgument where there is none of that name.
Result<Order> order_named(std::string_view name);

/// How many actions of each kind; the paper's Table 7 columns are among them.
struct ActionCounts {
  std::array<int, kActionKindNames.size()> by_kind{};
  [[nodiscard]] int of(ActionKind kind) const { return by_kind.at(static_cast<std::size_t>(kind)); }
  [[nodiscard]] int state_changes() const;  ///< recover + stop + cleanup + configure + start
  [[nodiscard]] int total() const;
};

/// Turns one network into another: actions in an executable order, with the partial order behind it.
struct Transition {
  NetworkName from;
  NetworkName to;
  Order order = Order::Seamless;
  std::vector<Action> actions;
  std::vector<TaskId> removes;  ///< tasks that leave the network (their processes may stay)
  std::vector<Task> redefines;  ///< kept tasks whose definition changes without an action (e.g. takes_over)
  /// The name by which a robot that has it can be asked for it: that of its file, where that says no other.
  /// Empty where it was computed. Not compared, and neither is the rest.
  std::string name{};
  std::string file{};                    ///< where it was read from
  std::vector<SourceLocation> places{};  ///< of its actions, there

  [[nodiscard]] ActionCounts counts() const;
  friend bool operator==(const Transition& a, const Transition& b);
};

}  // namespace segue::model

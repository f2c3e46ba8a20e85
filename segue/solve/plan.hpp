// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/model/transition.hpp>
#include <segue/solve/solve.hpp>
#include <segue/solve/transition_index.hpp>

#include <cstdint>
#include <vector>

/// Decides the actions for each task, process and connection, without their order.
namespace segue::solve::detail {

/// The actions that a task needs, at most one of each kind.
class Steps {
 public:
  Steps() = default;
  Steps(std::initializer_list<model::ActionKind> kinds) {
    for (const model::ActionKind kind : kinds)
      add(kind);
  }
  void add(model::ActionKind kind) { bits_ = static_cast<std::uint16_t>(bits_ | bit(kind)); }
  void remove(model::ActionKind kind) { bits_ = static_cast<std::uint16_t>(bits_ & ~bit(kind)); }
  [[nodiscard]] bool has(model::ActionKind kind) const { return (bits_ & bit(kind)) != 0; }
  [[nodiscard]] bool empty() const { return bits_ == 0; }
  friend Steps operator+(Steps a, Steps b) {
    a.bits_ = static_cast<std::uint16_t>(a.bits_ | b.bits_);
    return a;
  }
  friend bool operator==(const Steps&, const Steps&) = default;

 private:
  static unsigned bit(model::ActionKind kind) { return 1U << static_cast<unsigned>(kind); }
  std::uint16_t bits_ = 0;
};

enum class TaskFate : std::uint8_t {
  Kept,     ///< the same incarnation in both networks
  Added,    ///< only in the target
  Removed,  ///< only in the current network
  Replaced  ///< a new incarnation of the same id replaces the old one
};

struct TaskPlan {
  TaskFate fate = TaskFate::Kept;
  bool live = false;  ///< its configuration is applied without a state change
  Steps steps;
};

enum class ProcessFate : std::uint8_t { Kept, Deployed, Undeployed, Redeployed };

inline bool is_undeployed(ProcessFate fate) {
  return fate == ProcessFate::Undeployed || fate == ProcessFate::Redeployed;
}
inline bool is_deployed(ProcessFate fate) {
  return fate == ProcessFate::Deployed || fate == ProcessFate::Redeployed;
}
inline bool has_old(TaskFate fate) {
  return fate == TaskFate::Removed || fate == TaskFate::Replaced;
}
inline bool has_new(TaskFate fate) {
  return fate == TaskFate::Added || fate == TaskFate::Replaced;
}

struct ChangeSet {
  Options options;
  std::vector<TaskPlan> tasks;         ///< as in Index::tasks
  std::vector<ProcessFate> processes;  ///< as in Index::processes
  std::vector<bool> disconnect;        ///< the current network's connections
  std::vector<bool> connect;           ///< the target's connections
  [[nodiscard]] const TaskPlan& task(int number) const { return tasks[as_index(number)]; }
  [[nodiscard]] ProcessFate process(int number) const { return processes[as_index(number)]; }
  bool hands_over = false;  ///< some task has a HandOver step
  /// Whether the process is killed without stopping its tasks.
  [[nodiscard]] bool is_killed(int process) const {
    return options.force && is_undeployed(processes[as_index(process)]);
  }
};

/// Whether a connection of the current network exists: at a dynamic port of a task that is not configured it
/// does not.
bool exists(const Index& index, const IndexedConnection& connection);

/// Whether a running process of this deployer can create any component; others have a fixed set of tasks.
bool holds_any_component(const model::Deployment& deployment);

/// Fails (Unsupported) if the target needs a task, or a device of one, that is Fatal in the runtime's own
/// process, which cannot be restarted. One that it does not need is dropped.
/// Plans a hand-over wherever both tasks have suitable states; whether the order allows it is checked later.
/// The paper's order never allows any.
Result<ChangeSet> make_plan(const Index& index, const Options& options);

}  // namespace segue::solve::detail

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/activity.hpp>
#include <segue/base/clock.hpp>
#include <segue/base/error.hpp>
#include <segue/base/life_cycle.hpp>
#include <segue/base/policy.hpp>
#include <segue/model/ids.hpp>
#include <segue/type/value.hpp>

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

namespace segue::model {

/// The reaction of the runtime to a fault of a task, process or connection.
enum class FailurePolicy : std::uint8_t {
  Report,   ///< reports it
  Recover,  ///< recovers tasks from errors, and recreates missing parts
  Restart,  ///< replaces the task by a new one, in a new process if its own has failed
  Fallback  ///< switches to the robot's fallback controller
};
inline constexpr std::array<std::string_view, 4> kFailurePolicyNames = {"report", "recover", "restart",
                                                                        "fallback"};
inline std::string_view to_string(FailurePolicy policy) {
  return kFailurePolicyNames.at(static_cast<std::size_t>(policy));
}

/// An instance of a component. Comparison ignores `where` (its place in a file), here and below.
struct Task {
  TaskId id;
  ComponentName component;
  /// As a target: PreOperational, Stopped or Running. As belief: any state.
  TaskState state = TaskState::Running;
  std::vector<std::string> config_names;     ///< Rock's configuration sections, in order; later wins
  type::Value properties{type::ValueMap{}};  ///< a map; entries override the sections
  std::optional<Activity> activity;          ///< nothing: the component's default
  std::vector<std::string> exclusive;        ///< devices that only one configured task may hold
  /// The task whose state this one continues when it replaces that; its own id: when it moves to another
  /// process.
  std::optional<TaskId> takes_over;
  std::optional<FailurePolicy> on_failure;  ///< nothing: its deployment's
  SourceLocation where;

  friend bool operator==(const Task& a, const Task& b);
  /// Whether no reconfiguration is needed: equal properties, sections, activity and devices.
  [[nodiscard]] bool same_configuration(const Task& other) const;
};

/// A connection of an output port to an input port, identified by (from, to, policy); its key in a file has
/// no meaning.
struct Connection {
  PortRef from;
  PortRef to;
  Policy policy;
  SourceLocation where;

  friend bool operator==(const Connection& a, const Connection& b) {
    return a.from == b.from && a.to == b.to && a.policy == b.policy;
  }
};
std::string to_string(
    const Connection& connection);  ///< "a.out -> b.in" and the policy where it is not plain data

/// The placement of a task in a deployment.
struct Placement {
  TaskId task;
  std::string name;  ///< its name inside the process; usually the task's id
  friend bool operator==(const Placement&, const Placement&) = default;
};

/// Resource limits of a process. Nothing: those of the process server.
struct ResourceLimits {
  /// Bytes of private memory (RLIMIT_DATA), without shared memory and program code.
  std::optional<std::uint64_t> memory;
  std::optional<std::uint64_t> open_files;  ///< descriptors
  std::optional<Duration> cpu_time;         ///< of all threads together; whole seconds
  std::optional<std::uint64_t> core;        ///< size of a core file in bytes; 0: none

  friend bool operator==(const ResourceLimits&, const ResourceLimits&) = default;
  [[nodiscard]] bool empty() const { return *this == ResourceLimits{}; }
};

/// Deployment::deployer of processes that Segue's process server starts.
inline constexpr std::string_view kOwnDeployer = "segue";

/// A process on a host that holds tasks. Identity: key().
struct Deployment {
  HostName host = kLocalHost;
  ProcessName process;
  std::vector<Placement> tasks;        ///< may name tasks that the network lacks (as some real files do)
  std::string deployer{kOwnDeployer};  ///< who starts the process; "orogen" for Rock's
  Scheduler scheduler = Scheduler::Normal;
  int priority = 0;
  std::vector<int> cpus;
  bool optional = false;  ///< run as Normal where the system does not permit the scheduler
  std::vector<std::pair<std::string, std::string>> environment;
  ResourceLimits limits{};
  /// The policy for its tasks and for the process itself; nothing: the robot's policy. It does not affect
  /// what runs, so same_process() and differences() ignore it; it is read from the requested network.
  std::optional<FailurePolicy> on_failure{};
  /// Component libraries that only this process loads, beside those of the robot. Their components are never
  /// replaced by stand-ins.
  std::vector<std::string> libraries{};
  SourceLocation where;

  [[nodiscard]] DeploymentKey key() const { return {host, process}; }
  friend bool operator==(const Deployment& a, const Deployment& b);
  /// Whether no new process is needed: equal attributes, whatever the tasks.
  [[nodiscard]] bool same_process(const Deployment& other) const;
};

/// A controller: tasks, connections, deployments. Lists keep the order of the file.
struct Network {
  NetworkName name;
  std::vector<Task> tasks;
  std::vector<Deployment> deployments;
  std::vector<Connection> connections;
  std::string file;  ///< where it was read from; not compared
  /// Names the text that it was read from: the first 12 digits of its SHA-256. Empty where it was not read.
  /// Not compared.
  std::string version;

  /// Linear search; whoever looks for many tasks uses a TaskIndex.
  [[nodiscard]] const Task* find_task(const TaskId& id) const;
  [[nodiscard]] Task* find_task(const TaskId& id);
  [[nodiscard]] bool empty() const { return tasks.empty() && deployments.empty() && connections.empty(); }

  friend bool operator==(const Network& a, const Network& b);
};

/// The tasks of a network by id. Refers to the network, which outlives it and keeps its tasks where they are.
class TaskIndex {
 public:
  explicit TaskIndex(const Network& network);
  /// nullptr where the network has no such task. Constant time.
  [[nodiscard]] const Task* find(const TaskId& id) const;
  /// How many different ids there are.
  [[nodiscard]] std::size_t size() const { return tasks_.size(); }

 private:
  std::unordered_map<std::string_view, const Task*> tasks_;
};

/// Whether both describe the same controller. Ignores names of networks, order of lists, and placements of
/// tasks that the network lacks. Linear in the size of the networks.
bool equivalent(const Network& a, const Network& b);

/// The process of each task that a deployment holds; tasks of the runtime's own process are left out. Where
/// several deployments name a task, the first counts. Linear in the size of the network.
std::map<TaskId, DeploymentKey> task_processes(const Network& network);

/// Why a connection that was expected is not there; empty where nothing is known.
using WhyMissing = std::function<std::string(const Connection& connection)>;

inline constexpr std::size_t kMostDifferences = 10;
/// The first few differences as sentences ("task 'slam' is missing"), for messages and tests; empty if
/// equivalent(). Those of missing connections have the reason that `why_missing` gives.
std::vector<std::string> differences(const Network& expected, const Network& found,
                                     std::size_t limit = kMostDifferences,
                                     const WhyMissing& why_missing = {});
/// The first few changes from one version of a controller to the next as sentences: "task 'slam' is added",
/// "task 'drive': property 'gain': 1 -> 2"; empty if equivalent().
std::vector<std::string> changes(const Network& before, const Network& after,
                                 std::size_t limit = kMostDifferences);

}  // namespace segue::model

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/model/component_model.hpp>
#include <segue/model/network.hpp>
#include <segue/solve/component_facts.hpp>
#include <segue/solve/hash_index.hpp>
#include <segue/solve/solve.hpp>

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace segue::solve::detail {

/// The two networks of a transition, as array positions.
enum Side : std::size_t { kCurrent = 0, kTarget = 1 };

/// The number of the runtime's own process, which holds the tasks without deployment. It is neither deployed
/// nor undeployed.
inline constexpr int kRuntime = 0;

/// A task in one of the two networks, and its process there.
struct TaskIncarnation {
  const model::Task* task = nullptr;  ///< nullptr: this network lacks it
  ComponentFacts component;
  int process = kRuntime;
  std::string_view name;  ///< inside the process
};

/// An exclusive device: the same name on two hosts means two devices.
inline std::string device_key(const model::HostName& host, const std::string& device) {
  return host == model::kLocalHost ? device : host.str() + ":" + device;
}

/// A task id with its incarnations in both networks.
struct IndexedTask {
  std::array<TaskIncarnation, 2> on;
  int takes_over = kNone;  ///< the current task whose state the target's task continues
  /// The task of the current network that a prepared incarnation replaces; kNone: none.
  int replaces = kNone;
  bool is_replaced = false;  ///< by a prepared incarnation
  bool idle = false;         ///< see Options::idle
  /// Whether the target's task is the current one, prepared where the target places it.
  bool prepared = false;
  [[nodiscard]] const TaskIncarnation& current() const { return on[kCurrent]; }
  [[nodiscard]] const TaskIncarnation& target() const { return on[kTarget]; }
  [[nodiscard]] bool in_both() const { return current().task != nullptr && target().task != nullptr; }
};

struct IndexedProcess {
  std::array<const model::Deployment*, 2> on{};
  [[nodiscard]] const model::Deployment* current() const { return on[kCurrent]; }
  [[nodiscard]] const model::Deployment* target() const { return on[kTarget]; }
};

struct IndexedConnection {
  const model::Connection* connection = nullptr;
  int from = kNone;  ///< task
  int to = kNone;
  bool from_dynamic = false;
  bool to_dynamic = false;
  int partner = kNone;  ///< the connection of the same ports in the other network, whatever its policy
};

/// Both networks with every name resolved to a number. Tasks of the current network come first, in its order.
/// Points into the networks and the catalog, which must outlive it.
struct Index {
  Interner ids{0};  ///< numbers of the tasks
  std::vector<IndexedTask> tasks;
  std::vector<int> target_order;  ///< the tasks of the target in its order
  std::vector<IndexedProcess> processes;
  std::array<std::vector<int>, 2> process_order;              ///< per network, in its order
  std::array<std::vector<IndexedConnection>, 2> connections;  ///< per network, in its order
  std::size_t current_tasks = 0;
  bool tasks_renamed = false;  ///< some task has another name inside its process than its id

  [[nodiscard]] const IndexedTask& task(int number) const { return tasks[as_index(number)]; }
  [[nodiscard]] const IndexedProcess& process(int number) const { return processes[as_index(number)]; }
};

/// Tasks of one network by process and name inside it.
class OccupantIndex {
 public:
  OccupantIndex(const Index& index, Side side);
  /// The task of that name in the process, or kNone.
  [[nodiscard]] int find(int process, std::string_view name) const;

 private:
  static std::size_t hash(int process, std::string_view name);
  const Index& index_;
  Side side_;
  HashIndex occupants_;
};

/// Fails (InvalidArgument) if a network refers to a missing part or defines one twice, if a target state is
/// an error that the task is not in already, or if the target uses a dynamic port of a task that it does not
/// configure.
Result<Index> build_index(const model::Network& current, const model::Network& target,
                          const model::ComponentCatalog& catalog, const Options& options);

/// Whether the task is configured, so that its dynamic ports exist.
bool is_configured(const TaskIncarnation& incarnation);

}  // namespace segue::solve::detail

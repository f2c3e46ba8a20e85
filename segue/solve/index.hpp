// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/model/component.hpp>
#include <segue/model/network.hpp>
#include <segue/solve/component_facts.hpp>
#include <segue/solve/hash_index.hpp>

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace segue::solve::detail {

/// The two networks of a transition, as positions in arrays.
enum Side : std::size_t { kCurrent = 0, kTarget = 1 };

/// The number of the process that tasks of no deployment live in. It is never deployed nor undeployed.
inline constexpr int kRuntime = 0;

/// A task as one of the two networks has it, and where it lives there.
struct Incarnation {
  const model::Task* task = nullptr;  ///< nullptr: this network lacks it
  ComponentFacts component;
  int process = kRuntime;
  std::string_view name;  ///< inside the process
};

/// An exclusive device: the same name on two hosts means two devices.
inline std::string device_key(const model::HostName& host, const std::string& device) {
  return host == model::kLocalHost ? device : host.str() + ":" + device;
}

/// A task id and what both networks make of it.
struct TaskEntry {
  std::array<Incarnation, 2> on;
  int takes_over = kNone;  ///< the task whose state the target's one continues, if the current network has it
  [[nodiscard]] const Incarnation& current() const { return on[kCurrent]; }
  [[nodiscard]] const Incarnation& target() const { return on[kTarget]; }
  [[nodiscard]] bool in_both() const { return current().task != nullptr && target().task != nullptr; }
};

struct ProcessEntry {
  std::array<const model::Deployment*, 2> on{};
  [[nodiscard]] const model::Deployment* current() const { return on[kCurrent]; }
  [[nodiscard]] const model::Deployment* target() const { return on[kTarget]; }
};

struct Wire {
  const model::Connection* connection = nullptr;
  int from = kNone;  ///< task
  int to = kNone;
  bool from_dynamic = false;
  bool to_dynamic = false;
  int partner = kNone;  ///< the wire with the same ends in the other network, whatever its policy
};

/// Both networks with every name resolved to a number, once. Tasks: those of the current network first, in
/// its order. Points into the networks and the catalog, which must outlive it.
struct Index {
  Interner ids{0};  ///< the tasks' numbers
  std::vector<TaskEntry> tasks;
  std::vector<int> target_order;  ///< the tasks of the target in its order
  std::vector<ProcessEntry> processes;
  std::array<std::vector<int>, 2> process_order;  ///< per network, in its order
  std::array<std::vector<Wire>, 2> wires;         ///< per network, in its order
  std::size_t current_tasks = 0;
  bool tasks_renamed = false;  ///< some task has another name inside its process than its id

  [[nodiscard]] const TaskEntry& task(int number) const { return tasks[as_index(number)]; }
  [[nodiscard]] const ProcessEntry& process(int number) const { return processes[as_index(number)]; }
};

/// Tasks of one network by their place: (process, name inside it).
class OccupantIndex {
 public:
  OccupantIndex(const Index& index, Side side);
  /// The task in that place, or kNone.
  [[nodiscard]] int find(int process, std::string_view name) const;

 private:
  static std::size_t hash(int process, std::string_view name);
  const Index& index_;
  Side side_;
  HashIndex occupants_;
};

/// Fails (InvalidArgument) where a network names what it does not have or names a thing twice, where a target
/// state is an error that the task is not in already, or where the target needs a dynamic port of a task that
/// is not to be configured.
Result<Index> build_index(const model::Network& current, const model::Network& target,
                          const model::ComponentCatalog& catalog);

/// Whether the task has its dynamic ports: configured, whatever it is to become.
bool is_configured(const Incarnation& incarnation);

}  // namespace segue::solve::detail

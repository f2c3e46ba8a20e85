// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/component_model.hpp>
#include <segue/model/network.hpp>

#include <algorithm>
#include <bitset>
#include <cstdint>
#include <queue>
#include <string>
#include <unordered_map>
#include <vector>

/// Finds the length of the shortest graceful transition by exhaustive search (A* with an admissible
/// heuristic). Knows the rules of the life cycle only. For small networks: up to 6 placements, 3 processes, 8
/// connections.
namespace segue::testing {

class ShortestTransition {
 public:
  ShortestTransition(const model::Network& current, const model::Network& target,
                     const model::ComponentCatalog& catalog)
      : catalog_(catalog) {
    processes_.push_back({{}, nullptr, nullptr});
    for (const auto& deployment : current.deployments)
      process_of(deployment.key()).now = &deployment;
    for (const auto& deployment : target.deployments)
      process_of(deployment.key()).then = &deployment;
    for (const auto& task : current.tasks)
      slot_of(current, task).now = &task;
    for (const auto& task : target.tasks)
      slot_of(target, task).then = &task;
    for (const auto& connection : current.connections)
      add_wire(current, connection).now = true;
    for (const auto& connection : target.connections)
      add_wire(target, connection).then = true;
  }

  /// The number of actions, or -1 if no sequence reaches the target.
  int length() {
    using Entry = std::pair<int, Key>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    std::unordered_map<Key, int> cost;
    const Key first = pack(initial());
    cost[first] = 0;
    open.push({bound(unpack(first)), first});
    while (!open.empty()) {
      const auto [estimate, key] = open.top();
      open.pop();
      const State state = unpack(key);
      const int so_far = cost.at(key);
      if (estimate > so_far + bound(state)) continue;
      if (bound(state) == 0 && is_target(state)) return so_far;
      expand(state, [&](const State& next) {
        const Key found = pack(next);
        const auto known = cost.find(found);
        if (known != cost.end() && known->second <= so_far + 1) return;
        cost[found] = so_far + 1;
        open.push({so_far + 1 + bound(next), found});
      });
    }
    return -1;
  }

 private:
  using Key = std::uint64_t;
  enum Occupant : std::uint8_t { kNone, kOld, kNew };  ///< kNew: with the target's configuration
  enum Attributes : std::uint8_t { kOff, kAsNow, kAsThen };
  struct Slot {
    std::size_t process;
    std::string name;
    const model::Task* now = nullptr;
    const model::Task* then = nullptr;
  };
  struct Process {
    model::DeploymentKey key;
    const model::Deployment* now;
    const model::Deployment* then;
  };
  struct Wire {
    model::Connection connection;
    std::size_t from;
    std::size_t to;
    bool now = false;
    bool then = false;
  };
  struct Occupancy {
    Occupant occupant = kNone;
    TaskState state = TaskState::PreOperational;
  };
  struct State {
    std::vector<Occupancy> slots;
    std::vector<Attributes> processes;
    std::vector<bool> wires;
  };

  Process& process_of(const model::DeploymentKey& key) {
    for (auto& process : processes_) {
      if (process.key == key) return process;
    }
    return processes_.emplace_back(Process{key, nullptr, nullptr});
  }

  Slot& slot_of(const model::Network& network, const model::Task& task) {
    model::DeploymentKey key;
    std::string name = task.id.str();
    for (const auto& deployment : network.deployments) {
      for (const auto& placement : deployment.tasks) {
        if (placement.task != task.id) continue;
        key = deployment.key();
        name = placement.name;
      }
    }
    const auto process = static_cast<std::size_t>(&process_of(key) - processes_.data());
    for (auto& slot : slots_) {
      if (slot.process == process && slot.name == name) return slot;
    }
    return slots_.emplace_back(Slot{process, name});
  }

  std::size_t slot_number(const model::Network& network, const model::TaskId& id) {
    return static_cast<std::size_t>(&slot_of(network, *network.find_task(id)) - slots_.data());
  }

  /// A connection of both networks is the same one if its tasks may stay as they are.
  Wire& add_wire(const model::Network& network, const model::Connection& connection) {
    const std::size_t from = slot_number(network, connection.from.task);
    const std::size_t to = slot_number(network, connection.to.task);
    for (auto& wire : wires_) {
      if (wire.connection == connection && wire.from == from && wire.to == to && same_task(from) &&
          same_task(to)) {
        return wire;
      }
    }
    return wires_.emplace_back(Wire{connection, from, to});
  }

  [[nodiscard]] bool same_task(std::size_t slot) const {
    const model::Task* now = slots_[slot].now;
    const model::Task* then = slots_[slot].then;
    return now && then && now->id == then->id && now->component == then->component;
  }
  [[nodiscard]] bool same_definition(std::size_t slot) const {
    return same_task(slot) && slots_[slot].now->same_configuration(*slots_[slot].then);
  }
  [[nodiscard]] const model::Task* task_in(const State& state, std::size_t slot) const {
    if (state.slots[slot].occupant == kNone) return nullptr;
    return state.slots[slot].occupant == kNew ? slots_[slot].then : slots_[slot].now;
  }
  static bool configured(TaskState state) {
    return state == TaskState::Stopped || state == TaskState::Running || state == TaskState::RunTimeError;
  }

  State initial() {
    State state;
    for (std::size_t i = 0; i < slots_.size(); ++i) {
      Occupancy occupancy;
      if (slots_[i].now) occupancy = {same_definition(i) ? kNew : kOld, slots_[i].now->state};
      state.slots.push_back(occupancy);
    }
    for (const auto& process : processes_) {
      const bool same = process.now && process.then && process.now->same_process(*process.then);
      state.processes.push_back(!process.now ? kOff : same ? kAsThen : kAsNow);
    }
    state.processes[0] = kAsThen;
    for (const auto& wire : wires_) {
      const bool lost =
          (!configured(state.slots[wire.from].state) &&
           is_dynamic(state, wire.from, wire.connection.from.port)) ||
          (!configured(state.slots[wire.to].state) && is_dynamic(state, wire.to, wire.connection.to.port));
      state.wires.push_back(wire.now && !lost);
    }
    return state;
  }

  bool is_dynamic(const State& state, std::size_t slot, const std::string& port) const {
    const model::Task* task = task_in(state, slot);
    const auto* model = task ? catalog_.find(task->component) : nullptr;
    if (!model) return false;
    return std::any_of(model->ports.begin(), model->ports.end(), [&](const auto& candidate) {
      const bool fits = candidate.pattern ? port.starts_with("dyn_") : candidate.name == port;
      return fits && (candidate.dynamic || candidate.pattern);
    });
  }

  Key pack(const State& state) const {
    Key key = 0;
    for (const Occupancy& occupancy : state.slots) {
      key = key * 13 + (occupancy.occupant == kNone
                            ? 0
                            : 1 + 6 * (occupancy.occupant - 1) + static_cast<Key>(occupancy.state));
    }
    for (const Attributes attributes : state.processes)
      key = key * 3 + attributes;
    for (const bool wire : state.wires)
      key = key * 2 + (wire ? 1 : 0);
    return key;
  }

  State unpack(Key key) const {
    State state{std::vector<Occupancy>(slots_.size()), std::vector<Attributes>(processes_.size()),
                std::vector<bool>(wires_.size())};
    const auto take = [&](Key base) {
      const Key digit = key % base;
      key /= base;
      return digit;
    };
    for (std::size_t i = wires_.size(); i-- > 0;)
      state.wires[i] = take(2) == 1;
    for (std::size_t i = processes_.size(); i-- > 0;)
      state.processes[i] = static_cast<Attributes>(take(3));
    for (std::size_t i = slots_.size(); i-- > 0;) {
      const Key code = take(13);
      if (code > 0) state.slots[i] = {code > 6 ? kNew : kOld, static_cast<TaskState>((code - 1) % 6)};
    }
    return state;
  }

  /// A lower bound: actions that are certainly needed, each counted for one subject.
  [[nodiscard]] int bound(const State& state) const {
    int needed = 0;
    for (std::size_t i = 0; i < wires_.size(); ++i)
      needed += state.wires[i] != wires_[i].then ? 1 : 0;
    for (std::size_t i = 1; i < processes_.size(); ++i) {
      const bool wanted = processes_[i].then != nullptr;
      needed +=
          state.processes[i] == kAsNow ? 1 + (wanted ? 1 : 0) : (state.processes[i] == kAsThen) != wanted;
    }
    for (std::size_t i = 0; i < slots_.size(); ++i)
      needed += bound(state, i);
    return needed;
  }

  [[nodiscard]] int bound(const State& state, std::size_t i) const {
    const Occupancy& occupancy = state.slots[i];
    const bool lasts = state.processes[slots_[i].process] != kAsNow;  // else it ends with its process
    const bool stays = lasts && (occupancy.occupant == kNew || (occupancy.occupant == kOld && same_task(i)));
    if (!slots_[i].then || !stays) {
      const int down = occupancy.occupant == kNone             ? 0
                       : occupancy.state == TaskState::Stopped ? 1
                       : configured(occupancy.state)           ? 2
                                                               : 0;
      if (!slots_[i].then) return down;
      return down + 1 + static_cast<int>(slots_[i].then->state);
    }
    return (occupancy.occupant == kOld ? 1 : 0) + (occupancy.state == slots_[i].then->state ? 0 : 1);
  }

  /// bound() is zero if connections, processes and wanted tasks are right; this checks for leftovers.
  [[nodiscard]] bool is_target(const State& state) const {
    for (std::size_t i = 0; i < slots_.size(); ++i) {
      const Occupancy& occupancy = state.slots[i];
      if (slots_[i].then || occupancy.occupant == kNone) continue;
      if (occupancy.state != TaskState::PreOperational) return false;
    }
    return true;
  }

  template <class Visit>
  void expand(const State& state, const Visit& visit) {
    for (std::size_t i = 0; i < slots_.size(); ++i) {
      expand_life_cycle(state, i, visit);
      expand_apply(state, i, visit);
    }
    for (std::size_t i = 0; i < wires_.size(); ++i)
      expand_wire(state, i, visit);
    for (std::size_t i = 1; i < processes_.size(); ++i)
      expand_process(state, i, visit);
  }

  template <class Visit>
  void expand_life_cycle(const State& state, std::size_t i, const Visit& visit) {
    const Occupancy& occupancy = state.slots[i];
    if (occupancy.occupant == kNone) return;
    const auto go = [&](TaskState next) {
      State after = state;
      after.slots[i].state = next;
      visit(after);
    };
    switch (occupancy.state) {
      case TaskState::RunTimeError:
        go(TaskState::Running);
        go(TaskState::Stopped);
        return;
      case TaskState::Exception:
        go(TaskState::PreOperational);
        return;
      case TaskState::Running:
        go(TaskState::Stopped);
        return;
      case TaskState::PreOperational:
        if (devices_free(state, i)) go(TaskState::Stopped);
        return;
      case TaskState::Stopped:
        if (!runs_elsewhere(state, i)) go(TaskState::Running);
        if (!has_dynamic_wires(state, i)) go(TaskState::PreOperational);
        return;
      case TaskState::Fatal:
        return;
    }
  }

  [[nodiscard]] std::vector<std::string> devices(const model::Task& task) const {
    std::vector<std::string> found = task.exclusive;
    if (const auto* model = catalog_.find(task.component)) {
      found.insert(found.end(), model->exclusive.begin(), model->exclusive.end());
    }
    return found;
  }

  bool devices_free(const State& state, std::size_t slot) const {
    const auto mine = devices(*task_in(state, slot));
    for (std::size_t i = 0; !mine.empty() && i < slots_.size(); ++i) {
      const Occupancy& occupancy = state.slots[i];
      if (i == slot || occupancy.occupant == kNone) continue;
      if (!configured(occupancy.state) && occupancy.state != TaskState::Fatal) continue;
      for (const auto& device : devices(*task_in(state, i))) {
        if (std::find(mine.begin(), mine.end(), device) != mine.end()) return false;
      }
    }
    return true;
  }

  bool runs_elsewhere(const State& state, std::size_t slot) const {
    for (std::size_t i = 0; i < slots_.size(); ++i) {
      if (i == slot || state.slots[i].occupant == kNone) continue;
      const bool runs =
          state.slots[i].state == TaskState::Running || state.slots[i].state == TaskState::RunTimeError;
      if (runs && task_in(state, i)->id == task_in(state, slot)->id) return true;
    }
    return false;
  }

  bool has_dynamic_wires(const State& state, std::size_t slot) const {
    for (std::size_t i = 0; i < wires_.size(); ++i) {
      if (!state.wires[i]) continue;
      const Wire& wire = wires_[i];
      if (wire.from == slot && is_dynamic(state, slot, wire.connection.from.port)) return true;
      if (wire.to == slot && is_dynamic(state, slot, wire.connection.to.port)) return true;
    }
    return false;
  }

  bool has_wires(const State& state, std::size_t slot) const {
    for (std::size_t i = 0; i < wires_.size(); ++i) {
      if (state.wires[i] && (wires_[i].from == slot || wires_[i].to == slot)) return true;
    }
    return false;
  }

  template <class Visit>
  void expand_apply(const State& state, std::size_t i, const Visit& visit) {
    const Occupancy& occupancy = state.slots[i];
    if (!slots_[i].then || occupancy.occupant == kNew || state.processes[slots_[i].process] == kOff) return;
    State after = state;
    after.slots[i].occupant = kNew;
    if (occupancy.occupant == kOld && same_task(i)) {
      if (occupancy.state == TaskState::PreOperational || (configured(occupancy.state) && differs_live(i)))
        visit(after);
      return;
    }
    if (works_in_process(state, i)) return;
    if (occupancy.occupant == kOld) {
      if (occupancy.state != TaskState::PreOperational || has_wires(state, i)) return;
      const Process& process = processes_[slots_[i].process];
      const bool foreign = process.now && process.now->deployer != "segue";
      if (foreign && slots_[i].now->component != slots_[i].then->component) return;
    }
    after.slots[i].state = TaskState::PreOperational;
    visit(after);
  }

  bool works_in_process(const State& state, std::size_t slot) const {
    for (std::size_t i = 0; i < slots_.size(); ++i) {
      if (i == slot || slots_[i].process != slots_[slot].process || !task_in(state, i)) continue;
      if (task_in(state, i)->id == slots_[slot].then->id && configured(state.slots[i].state)) return true;
    }
    return false;
  }

  bool differs_live(std::size_t slot) const {
    model::Task now = *slots_[slot].now;
    model::Task then = *slots_[slot].then;
    const auto* model = catalog_.find(now.component);
    if (!model) return false;
    for (const auto& property : model->properties) {
      if (!property.live) continue;
      now.properties.as_map().erase(property.name);
      then.properties.as_map().erase(property.name);
    }
    return now.same_configuration(then);
  }

  template <class Visit>
  void expand_wire(const State& state, std::size_t i, const Visit& visit) {
    State after = state;
    after.wires[i] = !state.wires[i];
    if (state.wires[i] || (wires_[i].then && can_connect(state, i))) visit(after);
  }

  bool can_connect(const State& state, std::size_t number) const {
    const Wire& wire = wires_[number];
    const auto ready = [&](std::size_t slot, const std::string& port) {
      const Occupancy& occupancy = state.slots[slot];
      if (occupancy.occupant == kNone || (occupancy.occupant == kOld && !same_task(slot))) return false;
      return configured(occupancy.state) || !is_dynamic(state, slot, port);
    };
    if (!ready(wire.from, wire.connection.from.port) || !ready(wire.to, wire.connection.to.port))
      return false;
    for (std::size_t i = 0; i < wires_.size(); ++i) {
      const bool same =
          wires_[i].connection.from == wire.connection.from && wires_[i].connection.to == wire.connection.to;
      if (i != number && state.wires[i] && same && (wires_[i].from == wire.from || wires_[i].to == wire.to))
        return false;
    }
    return true;
  }

  template <class Visit>
  void expand_process(const State& state, std::size_t number, const Visit& visit) {
    State after = state;
    if (state.processes[number] == kOff) {
      if (!processes_[number].then) return;
      after.processes[number] = kAsThen;
      visit(after);
      return;
    }
    after.processes[number] = kOff;
    for (std::size_t i = 0; i < slots_.size(); ++i) {
      if (slots_[i].process != number || state.slots[i].occupant == kNone) continue;
      if (configured(state.slots[i].state) || has_wires(state, i)) return;
      after.slots[i] = {};
    }
    visit(after);
  }

  const model::ComponentCatalog& catalog_;
  std::vector<Process> processes_;
  std::vector<Slot> slots_;
  std::vector<Wire> wires_;
};

}  // namespace segue::testing

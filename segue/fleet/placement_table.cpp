// SPDX-License-Identifier: Apache-2.0
#include <segue/fleet/placement_table.hpp>

#include <segue/base/text.hpp>
#include <segue/task_host/full_id.hpp>

#include <algorithm>
#include <iterator>
#include <utility>

namespace segue::fleet::detail {

namespace {

/// The runtime's own process has one key, whatever its host is called.
model::DeploymentKey normal(const model::DeploymentKey& process) {
  return process.is_runtime() ? model::DeploymentKey{} : process;
}

}  // namespace

bool PlacementTable::Incarnations::has(const model::DeploymentKey& process) const {
  return std::find(processes.begin(), processes.end(), process) != processes.end();
}

void PlacementTable::Incarnations::add(const model::DeploymentKey& process) {
  if (!has(process)) {
    processes.push_back(process);
  }
}

void PlacementTable::Incarnations::settle() {
  if (!next && !processes.empty() && !has(current)) {
    current = processes.front();
  }
}

Error PlacementTable::unknown(const model::TaskId& id) const {
  std::vector<std::string> known;
  for (const auto& [task, incarnations] : table_) {
    known.push_back(task.str());
  }
  return fail(ErrorCode::NotFound, "no task " + quote(id.str()) + " runs" + did_you_mean(id.str(), known),
              id.str());
}

Result<PlacementTable::Place> PlacementTable::find(const model::TaskId& id, Which which) const {
  const auto [task, process] = task_host::split_id(id);
  const Lock lock(mutex_);
  const auto found = table_.find(task);
  if (found == table_.end()) {
    return unknown(id);
  }
  const Incarnations& there = found->second;
  const model::DeploymentKey meant = process                              ? normal(*process)
                                     : which == Which::Next && there.next ? *there.next
                                                                          : there.current;
  const bool ended = !process && which == Which::Current && ended_.contains(task);
  if (ended || !there.has(meant)) {
    return unknown(id);
  }
  return Place{task, meant};
}

Result<PlacementTable::Place> PlacementTable::free_place(const model::TaskId& id,
                                                         const model::DeploymentKey& process) const {
  const auto [task, key] = place_of(id, process);
  const bool exactly = task != id;
  const Lock lock(mutex_);
  const auto found = table_.find(task);
  if (found != table_.end() && !exactly) {
    const Incarnations& there = found->second;
    if (there.has(key) && there.current != key && there.next != key) {
      const std::string left = task_host::full_id(task, key).str();
      return fail(ErrorCode::InvalidState,
                  "an incarnation of it is still there as " + quote(left) + "; remove that one first", left);
    }
  }
  return Place{task, key};
}

PlacementTable::Place PlacementTable::place_of(const model::TaskId& id, const model::DeploymentKey& process) {
  return {task_host::plain_id(id), normal(process)};
}

model::TaskId PlacementTable::name_of(const Table::value_type& item, const model::DeploymentKey& process) {
  return item.second.current == process ? item.first : task_host::full_id(item.first, process);
}

model::TaskId PlacementTable::name(const model::TaskId& task, const model::DeploymentKey& process) const {
  const Lock lock(mutex_);
  const auto found = table_.find(task);
  return found == table_.end() ? task : name_of(*found, normal(process));
}

std::map<model::TaskId, model::DeploymentKey> PlacementTable::current() const {
  const Lock lock(mutex_);
  std::map<model::TaskId, model::DeploymentKey> current;
  for (const auto& [task, there] : table_) {
    current.emplace_hint(current.end(), task, there.current);
  }
  return current;
}

model::TaskId PlacementTable::name(const std::map<model::TaskId, model::DeploymentKey>& current,
                                   const model::TaskId& task, const model::DeploymentKey& process) {
  const auto found = current.find(task);
  const bool is_current = found == current.end() || found->second == normal(process);
  return is_current ? task : task_host::full_id(task, normal(process));
}

void PlacementTable::put(const Place& place) {
  const Lock lock(mutex_);
  auto [item, first] = table_.try_emplace(place.task);
  Incarnations& there = item->second;
  if (first) {
    there.current = place.process;
  } else if (there.current != place.process) {
    there.next = place.process;
  }
  there.add(place.process);
  note_change(place);
}

void PlacementTable::put_unconfirmed(const Place& place) {
  const Lock lock(mutex_);
  add(place);
  note_change(place);
}

void PlacementTable::note_creation(const Place& place, const Result<void>& outcome) {
  if (outcome) {
    put(place);
  } else if (outcome.error().code == ErrorCode::DeadlineExceeded ||
             outcome.error().code == ErrorCode::Unavailable) {
    put_unconfirmed(place);
  }
}

void PlacementTable::add(const Place& place) {
  auto [item, first] = table_.try_emplace(place.task);
  if (first) {
    item->second.current = place.process;
  }
  item->second.add(place.process);
}

void PlacementTable::note_change(const Place& place) {
  Process& process = by_process_[place.process];
  process.tasks.insert(place.task);
  process.changed[place.task] = ++changes_;
}

std::uint64_t PlacementTable::begin_poll() const {
  const Lock lock(mutex_);
  return changes_;
}

std::set<model::TaskId> PlacementTable::Process::changed_since(std::uint64_t poll) {
  std::set<model::TaskId> newer;
  for (auto change = changed.begin(); change != changed.end();) {
    if (change->second > poll) {
      newer.insert((change++)->first);
    } else {
      change = changed.erase(change);
    }
  }
  return newer;
}

void PlacementTable::update(const model::DeploymentKey& process, const std::set<model::TaskId>& tasks,
                            std::uint64_t poll) {
  const model::DeploymentKey key = normal(process);
  const Lock lock(mutex_);
  Process& there = by_process_[key];
  if (there.dropped > poll) {
    return;  // the report is of a former process of that name
  }
  const std::set<model::TaskId> newer = there.changed_since(poll);
  std::set<model::TaskId>& known = there.tasks;
  for (const auto& task : tasks) {
    if (!newer.contains(task) && known.insert(task).second) {
      add({task, key});
    }
  }
  for (auto task = known.begin(); task != known.end();) {
    if (tasks.contains(*task) || newer.contains(*task)) {
      ++task;
      continue;
    }
    remove(table_.find(*task), key);
    task = known.erase(task);
  }
}

PlacementTable::Table::iterator PlacementTable::remove(Table::iterator item,
                                                       const model::DeploymentKey& process) {
  Incarnations& there = item->second;
  std::erase(there.processes, process);
  if (in_transition_ && there.current == process) {
    ended_.insert(item->first);
  }
  if (there.next == process) {
    there.next.reset();
  }
  if (there.processes.empty()) {
    return table_.erase(item);
  }
  there.settle();
  return std::next(item);
}

void PlacementTable::drop(const Place& place) {
  const Lock lock(mutex_);
  Process& process = by_process_[place.process];
  process.changed[place.task] = ++changes_;
  if (process.tasks.erase(place.task) > 0) {
    remove(table_.find(place.task), place.process);
  }
}

std::vector<model::TaskId> PlacementTable::drop(const model::DeploymentKey& process) {
  const model::DeploymentKey key = normal(process);
  const Lock lock(mutex_);
  std::vector<model::TaskId> names;
  Process& there = by_process_[key];
  for (const auto& task : there.tasks) {
    const auto item = table_.find(task);
    names.push_back(name_of(*item, key));
    remove(item, key);
  }
  there = {{}, {}, ++changes_};
  return names;
}

void PlacementTable::begin_transition(const model::Network& before, const model::Network& target) {
  const auto processes = model::task_processes(target);
  const Lock lock(mutex_);
  in_transition_ = true;
  wanted_.clear();
  for (const auto& task : target.tasks) {
    const auto process = processes.find(task.id);
    wanted_.emplace(task.id, process == processes.end() ? model::DeploymentKey{} : normal(process->second));
  }
  ended_.clear();
  for (const auto& task : before.tasks) {
    if (!table_.contains(task.id)) {
      ended_.insert(task.id);
    }
  }
  for (auto& [task, there] : table_) {
    const auto wanted = wanted_.find(task);
    if (wanted != wanted_.end() && there.current != wanted->second && there.has(wanted->second)) {
      there.next = wanted->second;
    }
  }
}

std::optional<model::DeploymentKey> PlacementTable::wanted(const model::TaskId& task) const {
  const Lock lock(mutex_);
  const auto found = wanted_.find(task);
  return found == wanted_.end() ? std::nullopt : std::optional(found->second);
}

std::vector<PlacementTable::Place> PlacementTable::conclude() {
  const Lock lock(mutex_);
  std::vector<Place> replaced;
  in_transition_ = false;
  wanted_.clear();
  ended_.clear();
  for (auto& [task, there] : table_) {
    if (!there.next) {
      continue;
    }
    if (there.has(there.current)) {
      replaced.push_back({task, there.current});
    }
    there.current = *std::exchange(there.next, std::nullopt);
  }
  return replaced;
}

void PlacementTable::withdraw() {
  const Lock lock(mutex_);
  in_transition_ = false;
  wanted_.clear();
  ended_.clear();
  for (auto& [task, there] : table_) {
    there.next.reset();
    there.settle();
  }
}

}  // namespace segue::fleet::detail

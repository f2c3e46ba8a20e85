// SPDX-License-Identifier: Apache-2.0
#include <segue/deploy/seats.hpp>

#include <segue/base/text.hpp>
#include <segue/host/full_id.hpp>

#include <algorithm>
#include <utility>

namespace segue::deploy::detail {

namespace {

/// The runtime's own process has one key, whatever its host is called.
model::DeploymentKey normal(const model::DeploymentKey& process) {
  return process.is_runtime() ? model::DeploymentKey{} : process;
}

}  // namespace

bool Seats::Incarnations::has(const model::DeploymentKey& process) const {
  return std::find(processes.begin(), processes.end(), process) != processes.end();
}

void Seats::Incarnations::add(const model::DeploymentKey& process) {
  if (!has(process)) {
    processes.push_back(process);
  }
}

void Seats::Incarnations::settle() {
  if (!newest && !processes.empty() && !has(standing)) {
    standing = processes.front();
  }
}

Error Seats::unknown(const model::TaskId& id) const {
  std::vector<std::string> known;
  for (const auto& [task, incarnations] : table_) {
    known.push_back(task.str());
  }
  return fail(ErrorCode::NotFound, "no task " + quote(id.str()) + " here" + did_you_mean(id.str(), known),
              id.str());
}

Result<Seats::Place> Seats::find(const model::TaskId& id, Which which) const {
  const auto [task, process] = host::split_id(id);
  const std::lock_guard lock(mutex_);
  const auto found = table_.find(task);
  if (found == table_.end()) {
    return unknown(id);
  }
  const Incarnations& there = found->second;
  const model::DeploymentKey meant = process                                  ? normal(*process)
                                     : which == Which::Newest && there.newest ? *there.newest
                                                                              : there.standing;
  if (!there.has(meant)) {
    return unknown(id);
  }
  return Place{task, meant};
}

Result<Seats::Place> Seats::free_place(const model::TaskId& id, const model::DeploymentKey& process) const {
  const auto [task, key] = place_of(id, process);
  const bool exactly = task != id;
  const std::lock_guard lock(mutex_);
  const auto found = table_.find(task);
  if (found != table_.end() && !exactly) {
    const Incarnations& there = found->second;
    if (there.has(key) && there.standing != key && there.newest != key) {
      const std::string left = host::full_id(task, key).str();
      return fail(ErrorCode::InvalidState,
                  "an incarnation of it is still there as " + quote(left) + "; remove that one first", left);
    }
  }
  return Place{task, key};
}

Seats::Place Seats::place_of(const model::TaskId& id, const model::DeploymentKey& process) {
  return {host::plain_id(id), normal(process)};
}

model::TaskId Seats::name_of(const Table::value_type& item, const model::DeploymentKey& process) {
  return item.second.standing == process ? item.first : host::full_id(item.first, process);
}

model::TaskId Seats::name(const model::TaskId& task, const model::DeploymentKey& process) const {
  const std::lock_guard lock(mutex_);
  const auto found = table_.find(task);
  return found == table_.end() ? task : name_of(*found, normal(process));
}

void Seats::put(const Place& place) {
  const std::lock_guard lock(mutex_);
  auto [item, first] = table_.try_emplace(place.task);
  Incarnations& there = item->second;
  if (first) {
    there.standing = place.process;
  } else if (there.standing != place.process) {
    there.newest = place.process;
  }
  there.add(place.process);
  note(place);
}

void Seats::put_unsure(const Place& place) {
  const std::lock_guard lock(mutex_);
  auto [item, first] = table_.try_emplace(place.task);
  if (first) {
    item->second.standing = place.process;
  }
  item->second.add(place.process);
  note(place);
}

void Seats::note(const Place& place) {
  Process& process = by_process_[place.process];
  process.tasks.insert(place.task);
  process.changed[place.task] = ++changes_;
}

std::uint64_t Seats::begin_look() const {
  const std::lock_guard lock(mutex_);
  return changes_;
}

std::set<model::TaskId> Seats::Process::changed_since(std::uint64_t look) {
  std::set<model::TaskId> newer;
  for (auto change = changed.begin(); change != changed.end();) {
    if (change->second > look) {
      newer.insert((change++)->first);
    } else {
      change = changed.erase(change);
    }
  }
  return newer;
}

void Seats::learn(const model::DeploymentKey& process, const std::set<model::TaskId>& tasks,
                  std::uint64_t look) {
  const model::DeploymentKey key = normal(process);
  const std::lock_guard lock(mutex_);
  Process& there = by_process_[key];
  if (there.dropped > look) {
    return;  // it was a process that is gone
  }
  const std::set<model::TaskId> newer = there.changed_since(look);
  std::set<model::TaskId>& known = there.tasks;
  for (const auto& task : tasks) {
    if (newer.contains(task) || !known.insert(task).second) {
      continue;
    }
    auto [item, first] = table_.try_emplace(task);
    if (first) {
      item->second.standing = key;
    }
    item->second.add(key);
  }
  for (auto task = known.begin(); task != known.end();) {
    if (tasks.contains(*task) || newer.contains(*task)) {
      ++task;
      continue;
    }
    take(table_.find(*task), key);
    task = known.erase(task);
  }
}

Seats::Table::iterator Seats::take(Table::iterator item, const model::DeploymentKey& process) {
  Incarnations& there = item->second;
  std::erase(there.processes, process);
  if (there.newest == process) {
    there.newest.reset();
  }
  if (there.processes.empty()) {
    return table_.erase(item);
  }
  there.settle();
  return std::next(item);
}

void Seats::drop(const Place& place) {
  const std::lock_guard lock(mutex_);
  Process& process = by_process_[place.process];
  process.changed[place.task] = ++changes_;
  if (process.tasks.erase(place.task) > 0) {
    take(table_.find(place.task), place.process);
  }
}

std::vector<model::TaskId> Seats::drop(const model::DeploymentKey& process) {
  const model::DeploymentKey key = normal(process);
  const std::lock_guard lock(mutex_);
  std::vector<model::TaskId> names;
  Process& there = by_process_[key];
  for (const auto& task : there.tasks) {
    const auto item = table_.find(task);
    names.push_back(name_of(*item, key));
    take(item, key);
  }
  there = {{}, {}, ++changes_};
  return names;
}

std::vector<Seats::Place> Seats::conclude() {
  const std::lock_guard lock(mutex_);
  std::vector<Place> replaced;
  for (auto& [task, there] : table_) {
    if (!there.newest) {
      continue;
    }
    if (there.has(there.standing)) {
      replaced.push_back({task, there.standing});
    }
    there.standing = *std::exchange(there.newest, std::nullopt);
  }
  return replaced;
}

void Seats::withdraw() {
  const std::lock_guard lock(mutex_);
  for (auto& [task, there] : table_) {
    there.newest.reset();
    there.settle();
  }
}

}  // namespace segue::deploy::detail

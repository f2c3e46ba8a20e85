// SPDX-License-Identifier: Apache-2.0
#include <segue/task_host/task_table.hpp>

#include <segue/base/text.hpp>

#include <iterator>
#include <utility>

namespace segue::task_host::detail {

namespace {

Error removed_meanwhile(const model::TaskId& id) {
  return fail(ErrorCode::NotFound, "task " + quote(id.str()) + " has been removed meanwhile", id.str());
}

}  // namespace

Error busy(const TaskEntry& entry) {
  return fail(ErrorCode::DeadlineExceeded, "a hook of the task has not returned", entry.definition.id.str());
}

Result<TimedReadLock> hold_ports(const TaskEntry& entry, TimePoint deadline) {
  TimedReadLock lock(*entry.ports, deadline);
  if (!lock) {
    return busy(entry);
  }
  return lock;
}

std::optional<TaskEntry> TaskTable::look_up(const model::TaskId& id) const {
  const ReadLock lock(mutex_);
  const auto found = tasks_.find(id);
  return found == tasks_.end() ? std::nullopt : std::optional(found->second);
}

Result<TaskEntry> TaskTable::find(const model::TaskId& id) const {
  if (auto entry = look_up(id)) {
    return std::move(*entry);
  }
  const ReadLock lock(mutex_);
  std::vector<std::string> known;
  for (const auto& [name, entry] : tasks_) {
    known.push_back(name.str());
  }
  return fail(ErrorCode::NotFound, "no task " + quote(id.str()) + " runs" + did_you_mean(id.str(), known),
              id.str());
}

std::vector<TaskEntry> TaskTable::all() const {
  const ReadLock lock(mutex_);
  std::vector<TaskEntry> entries;
  entries.reserve(tasks_.size());
  for (const auto& [id, entry] : tasks_) {
    entries.push_back(entry);
  }
  return entries;
}

std::vector<TaskEntry> TaskTable::in_process(const model::DeploymentKey& process) const {
  const ReadLock lock(mutex_);
  std::vector<TaskEntry> entries;
  for (const auto& [id, entry] : tasks_) {
    if (entry.process == process) {
      entries.push_back(entry);
    }
  }
  return entries;
}

Result<std::shared_ptr<task::Task>> TaskTable::put(TaskEntry entry) {
  const WriteLock lock(mutex_);
  if (!entry.process.is_runtime() && !processes_.contains(entry.process)) {
    const std::string process = quote(to_string(entry.process));
    return fail(ErrorCode::NotFound, "process " + process + " has ended meanwhile",
                entry.definition.id.str());
  }
  auto& place = tasks_[entry.definition.id];
  std::shared_ptr<task::Task> old = std::move(place.task);
  place = std::move(entry);
  return old;
}

Result<void> TaskTable::update(const task::Task* present, TaskEntry entry) {
  const WriteLock lock(mutex_);
  const model::TaskId id = entry.definition.id;
  if (!holds(id, present)) {
    return removed_meanwhile(id);
  }
  std::swap(tasks_.at(id), entry);
  return {};
}

bool TaskTable::holds(const model::TaskId& id, const task::Task* task) const {
  const auto found = tasks_.find(id);
  return found != tasks_.end() && found->second.task.get() == task;
}

std::shared_ptr<task::Task> TaskTable::take(const model::TaskId& id) {
  const WriteLock lock(mutex_);
  const auto found = tasks_.find(id);
  if (found == tasks_.end()) {
    return nullptr;
  }
  std::shared_ptr<task::Task> task = std::move(found->second.task);
  tasks_.erase(found);
  return task;
}

void TaskTable::redefine(const model::TaskId& id, const std::function<void(model::Task&)>& change) {
  const WriteLock lock(mutex_);
  if (const auto found = tasks_.find(id); found != tasks_.end()) {
    change(found->second.definition);
  }
}

Result<void> TaskTable::add_process(const model::Deployment& deployment) {
  const WriteLock lock(mutex_);
  ProcessEntry entry{deployment, std::make_shared<task::ExecutorSet>()};
  entry.deployment.tasks.clear();
  if (!processes_.try_emplace(deployment.key(), std::move(entry)).second) {
    const std::string name = to_string(deployment.key());
    return fail(ErrorCode::AlreadyExists, "process " + quote(name) + " is already deployed", name);
  }
  return {};
}

std::optional<ProcessEntry> TaskTable::find_process(const model::DeploymentKey& key) const {
  const ReadLock lock(mutex_);
  const auto found = processes_.find(key);
  return found == processes_.end() ? std::nullopt : std::optional(found->second);
}

std::vector<std::shared_ptr<task::Task>> TaskTable::take_process(const model::DeploymentKey& key) {
  const WriteLock lock(mutex_);
  std::vector<std::shared_ptr<task::Task>> taken;
  processes_.erase(key);
  for (auto place = tasks_.begin(); place != tasks_.end();) {
    if (place->second.process != key) {
      ++place;
      continue;
    }
    erase_connections_of(place->first);
    taken.push_back(std::move(place->second.task));
    place = tasks_.erase(place);
  }
  return taken;
}

std::vector<model::Deployment> TaskTable::processes() const {
  const ReadLock lock(mutex_);
  std::vector<model::Deployment> deployments;
  for (const auto& [key, entry] : processes_) {
    deployments.push_back(entry.deployment);
  }
  return deployments;
}

Result<void> TaskTable::add_connection(ConnectionEntry entry, const task::Task* from, const task::Task* to) {
  const WriteLock lock(mutex_);
  const model::Connection connection = entry.connection;
  for (const auto& [id, task] : {std::pair(connection.from.task, from), std::pair(connection.to.task, to)}) {
    if (!holds(id, task)) {
      return removed_meanwhile(id);
    }
  }
  const auto found = connections_.find(connection);
  if (found != connections_.end() && found->second.handle.is_connected()) {
    const std::string name = to_string(connection);
    return fail(ErrorCode::AlreadyExists, "is already connected", name);
  }
  readers_.insert(&connections_.insert_or_assign(connection, std::move(entry)).first->first);
  return {};
}

Result<ConnectionEntry> TaskTable::take_connection(const model::Connection& connection) {
  const WriteLock lock(mutex_);
  const auto found = connections_.find(connection);
  if (found == connections_.end() || !found->second.handle.is_connected()) {
    const std::string name = to_string(connection);
    return fail(ErrorCode::NotFound, "is not connected, so it cannot be disconnected", name);
  }
  return take(found);
}

void TaskTable::drop_ended_connections() {
  const WriteLock lock(mutex_);
  for (auto place = connections_.begin(); place != connections_.end();) {
    const auto next = std::next(place);
    if (!place->second.handle.is_connected()) {
      take(place);
    }
    place = next;
  }
}

void TaskTable::drop_ended_connections_of(const model::TaskId& id) {
  const WriteLock lock(mutex_);
  for (const auto& place : connections_of(id)) {
    if (!place->second.handle.is_connected()) {
      take(place);
    }
  }
}

std::vector<ConnectionEntry> TaskTable::take_connections_of(const model::TaskId& id) {
  const WriteLock lock(mutex_);
  return erase_connections_of(id);
}

std::vector<TaskTable::Connections::iterator> TaskTable::connections_of(const model::TaskId& id) {
  std::vector<Connections::iterator> places;
  const auto [first, last] = connections_.equal_range(id);
  for (auto place = first; place != last; ++place) {
    places.push_back(place);
  }
  const auto [first_read, last_read] = readers_.equal_range(id);
  for (auto read = first_read; read != last_read; ++read) {
    if ((*read)->from.task != id) {  // else it is there already
      places.push_back(connections_.find(**read));
    }
  }
  return places;
}

/// Dropping a handle calls no task.
ConnectionEntry TaskTable::take(Connections::iterator place) {
  ConnectionEntry entry = std::move(place->second);
  readers_.erase(&place->first);
  connections_.erase(place);
  return entry;
}

std::vector<ConnectionEntry> TaskTable::erase_connections_of(const model::TaskId& id) {
  std::vector<ConnectionEntry> taken;
  for (const auto& place : connections_of(id)) {
    taken.push_back(take(place));
  }
  return taken;
}

std::optional<ConnectionHandle> TaskTable::find_connection(const model::Connection& connection) const {
  const ReadLock lock(mutex_);
  const auto found = connections_.find(connection);
  const bool there = found != connections_.end() && found->second.handle.is_connected();
  return there ? std::optional(found->second.handle) : std::nullopt;
}

std::vector<ConnectionEntry> TaskTable::all_connections() const {
  const ReadLock lock(mutex_);
  std::vector<ConnectionEntry> all;
  for (const auto& [connection, entry] : connections_) {
    if (entry.handle.is_connected()) {
      all.push_back(entry);
    }
  }
  return all;
}

void TaskTable::clear() {
  std::map<model::TaskId, TaskEntry> tasks;
  Connections connections;
  const WriteLock lock(mutex_);
  readers_.clear();
  tasks.swap(tasks_);
  connections.swap(connections_);
  processes_.clear();
}

}  // namespace segue::task_host::detail

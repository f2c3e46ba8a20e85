// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/solve/placement_index.hpp>
#include <segue/solve/simulation.hpp>
#include <segue/solve/transition_index.hpp>

#include <utility>

/// The state of the simulation, and the network built from it.
namespace segue::solve::detail {

namespace {

using model::ActionKind;

/// Stands for the deployment of the runtime's own process.
const model::Deployment kRuntimeItself;

std::size_t hash_of_place(int process, std::string_view name) {
  return model::combine_hashes(std::hash<std::string_view>{}(name), as_index(process));
}

}  // namespace

Simulation::Simulation(const model::ComponentCatalog& catalog, Interner ids)
    : components_(catalog),
      ids_(std::move(ids)),
      pairs_(ids_.size()),
      process_numbers_(0),
      occupants_(ids_.size()),
      connections_by_ends_(ids_.size()) {
  processes_.push_back({&kRuntimeItself, true, {}});
}

int Simulation::add_task(const model::Task& definition, int process, std::string_view name) {
  const int number = static_cast<int>(tasks_.size());
  const int id = ids_.intern(definition.id.str());
  if (as_index(id) == pairs_.size()) pairs_.emplace_back();
  pairs_[as_index(id)].newest = number;
  tasks_.push_back({&definition, components_.of(definition.component), id, process, name});
  processes_[as_index(process)].tasks.push_back(number);
  occupants_.insert(hash_of_place(process, name), number);
  return number;
}

void Simulation::add_connection(const model::Connection& connection, int from, int to) {
  const int number = static_cast<int>(connections_.size());
  connections_.push_back({&connection, from, to});
  StoredConnection& stored = connections_.back();
  stored.next_of_from = std::exchange(task(from).first_connection, number);
  if (to != from) stored.next_of_to = std::exchange(task(to).first_connection, number);
  connections_by_ends_.insert(Ends{task(from).id, task(to).id, &connection}.hash(), number);
}

void Simulation::drop_connection(int connection) {
  connections_[as_index(connection)].exists = false;
}

void Simulation::drop_task(int number) {
  Instance& gone = task(number);
  if (!gone.exists) return;
  gone.exists = false;
  release_devices(number);
  for (int i = gone.first_connection; i != kNone; i = next_connection(i, number))
    drop_connection(i);
}

void Simulation::release_devices(int number) {
  for (const std::string& device : devices_of(number)) {
    const auto holder = holders_.find(device);
    if (holder != holders_.end() && holder->second == number) holders_.erase(holder);
  }
}

int Simulation::find_process(const model::DeploymentKey& key) const {
  if (key.is_runtime()) return kRuntime;
  return process_numbers_.find(std::hash<model::DeploymentKey>{}(key), [&](int number) {
    const Process& process = processes_[as_index(number)];
    return process.running && process.deployment->process == key.process &&
           process.deployment->host == key.host;
  });
}

int Simulation::find_occupant(int process, std::string_view name) const {
  return occupants_.find(hash_of_place(process, name), [&](int number) {
    return task(number).exists && task(number).process == process && task(number).name == name;
  });
}

int Simulation::find_newest(const model::TaskId& id) const {
  const int number = ids_.find(id.str());
  return number == kNone ? kNone : newest_of(pairs_[as_index(number)]);
}

int Simulation::newest_of(const Pair& pair) const {
  return pair.newest != kNone && task(pair.newest).exists ? pair.newest : kNone;
}

int Simulation::subject_of(const model::Action& action) const {
  const bool leads_out = action.kind == ActionKind::Recover || action.kind == ActionKind::Stop ||
                         action.kind == ActionKind::Cleanup;
  return leads_out ? find_going(*action.task()) : find_newest(*action.task());
}

int Simulation::find_going(const model::TaskId& id) const {
  const int number = ids_.find(id.str());
  if (number == kNone) return kNone;
  const Pair& pair = pairs_[as_index(number)];
  const bool is_out =
      pair.going == kNone || !task(pair.going).exists || task(pair.going).state == TaskState::PreOperational;
  return is_out ? newest_of(pair) : pair.going;
}

std::size_t Simulation::Ends::hash() const {
  const std::hash<std::string_view> hash_of;
  const std::size_t tasks = model::combine_hashes(as_index(from), as_index(to)) * 0x9e3779b97f4a7c15ULL;
  const std::size_t ports =
      model::combine_hashes(hash_of(connection->from.port), hash_of(connection->to.port));
  return model::combine_hashes(tasks, ports);
}

std::vector<int> Simulation::connections_between(const model::Connection& connection) const {
  const Ends ends{ids_.find(connection.from.task.str()), ids_.find(connection.to.task.str()), &connection};
  std::vector<int> found;
  if (ends.from == kNone || ends.to == kNone) return found;
  connections_by_ends_.each(ends.hash(), [&](int number) {
    const StoredConnection& stored = connections_[as_index(number)];
    const bool same = stored.exists && task(stored.from).id == ends.from && task(stored.to).id == ends.to &&
                      stored.connection->from.port == connection.from.port &&
                      stored.connection->to.port == connection.to.port;
    if (same) found.push_back(number);
  });
  return found;
}

bool Simulation::is_newest(int number) const {
  return newest_of(pairs_[as_index(task(number).id)]) == number;
}

bool Simulation::has_connection(int number) const {
  for (int i = task(number).first_connection; i != kNone; i = next_connection(i, number)) {
    if (connections_[as_index(i)].exists) return true;
  }
  return false;
}

bool Simulation::is_resting(int number) const {
  return task(number).state == TaskState::PreOperational && !has_connection(number);
}

std::vector<std::string> Simulation::devices_of(int number) const {
  const Instance& of = task(number);
  return exclusive_devices(*of.definition, of.component, processes_[as_index(of.process)].deployment->key());
}

Result<> Simulation::remove(const model::TaskId& id) {
  if (ids_.find(id.str()) == kNone) {
    return fail(ErrorCode::InvalidState, "task " + quote(id.str()) + " is to be removed, but does not exist",
                id.str());
  }
  const int number = find_newest(id);
  if (number == kNone) return {};
  if (!is_resting(number)) {
    return fail(ErrorCode::InvalidState,
                "task " + quote(id.str()) + " is to be removed, but is in state " +
                    std::string(to_string(task(number).state)) +
                    (has_connection(number) ? " and connected" : ""),
                id.str());
  }
  drop_task(number);
  return {};
}

Result<> Simulation::redefine(const model::Task& definition) {
  const int number = find_newest(definition.id);
  if (number == kNone || task(number).definition->component != definition.component ||
      !task(number).definition->same_configuration(definition)) {
    return fail(ErrorCode::InvalidState,
                "task " + quote(definition.id.str()) + " cannot be redefined without an action",
                definition.id.str());
  }
  task(number).definition = &definition;
  return {};
}

Result<model::Network> Simulation::network() const {
  model::Network network;
  network.tasks.reserve(tasks_.size());
  network.connections.reserve(connections_.size());
  std::vector<std::vector<model::Placement>> placements(processes_.size());
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    const Instance& found = tasks_[i];
    const int number = static_cast<int>(i);
    if (!found.exists) continue;
    if (is_newest(number)) {
      network.tasks.push_back(*found.definition);
      network.tasks.back().state = found.state;
      placements[as_index(found.process)].push_back({found.definition->id, std::string(found.name)});
    } else if (!is_resting(number)) {
      return fail(ErrorCode::InvalidState,
                  "the old incarnation of task " + quote(found.definition->id.str()) + " is left in state " +
                      std::string(to_string(found.state)) + (has_connection(number) ? " and connected" : ""),
                  found.definition->id.str());
    }
  }
  for (std::size_t i = 1; i < processes_.size(); ++i) {
    if (!processes_[i].running) continue;
    network.deployments.push_back(*processes_[i].deployment);
    network.deployments.back().tasks = std::move(placements[i]);
  }
  for (const StoredConnection& connection : connections_) {
    if (!connection.exists) continue;
    // While a transition replaces a connection by one with another policy, both exist.
    if (connections_between(*connection.connection).size() > 1) {
      const std::string name = to_string(*connection.connection);
      return fail(ErrorCode::InvalidState, "the two ports are left connected twice", name);
    }
    network.connections.push_back(*connection.connection);
  }
  return network;
}

}  // namespace segue::solve::detail

// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/solve/transition_index.hpp>

#include <string>
#include <utility>
#include <vector>

namespace segue::solve::detail {

namespace {

std::string_view side_name(Side side) {
  return side == kCurrent ? "current network" : "target";
}

std::string of(Side side) {
  return " of the " + std::string(side_name(side));
}

std::size_t hash_of_ends(const IndexedConnection& connection) {
  const std::hash<std::string> hash;
  const std::size_t tasks = model::combine_hashes(as_index(connection.from), as_index(connection.to));
  const std::size_t ports =
      model::combine_hashes(hash(connection.connection->from.port), hash(connection.connection->to.port));
  return model::combine_hashes(tasks * 0x9e3779b97f4a7c15ULL, ports);
}

bool same_ends(const IndexedConnection& a, const IndexedConnection& b) {
  return a.from == b.from && a.to == b.to && a.connection->from.port == b.connection->from.port &&
         a.connection->to.port == b.connection->to.port;
}

class Builder {
 public:
  Builder(const model::Network& current, const model::Network& target, const model::ComponentCatalog& catalog,
          const Options& options)
      : networks_{&current, &target},
        options_(options),
        components_(catalog),
        ids_(current.tasks.size() + target.tasks.size()),
        processes_(current.deployments.size() + target.deployments.size()),
        ends_(current.connections.size() + target.connections.size()) {
    index_.tasks.reserve(current.tasks.size() + target.tasks.size() / 8);
    index_.processes.emplace_back();
    index_.current_tasks = current.tasks.size();
  }

  Result<Index> build() {
    for (const Side side : {kCurrent, kTarget}) {
      if (auto done = add_tasks(side); !done) return done.error();
      if (auto done = add_deployments(side); !done) return done.error();
      if (auto done = add_connections(side); !done) return done.error();
    }
    if (auto done = check_places(); !done) return done.error();
    index_.ids = std::move(ids_);
    return std::move(index_);
  }

 private:
  Result<> add_tasks(Side side) {
    if (side == kTarget) index_.target_order.reserve(networks_[side]->tasks.size());
    for (const model::Task& task : networks_[side]->tasks) {
      if (auto done = add_task(side, task); !done) return done;
    }
    return {};
  }

  Result<> add_task(Side side, const model::Task& task) {
    if (side == kTarget && is_error(task.state) && !is_so_now(task)) {
      return fail(ErrorCode::InvalidArgument,
                  "task " + quote(task.id.str()) + of(side) + " is to be in state " +
                      std::string(to_string(task.state)) +
                      ", which is an error; ask for pre_operational, stopped or running",
                  task.id.str(), task.where);
    }
    const int number = ids_.intern(id_of(side, task.id).str());
    if (as_index(number) == index_.tasks.size()) index_.tasks.emplace_back();
    TaskIncarnation& incarnation = index_.tasks[as_index(number)].on[side];
    if (incarnation.task != nullptr) {
      return fail(ErrorCode::InvalidArgument,
                  "the " + std::string(side_name(side)) + " has two tasks " + quote(task.id.str()) +
                      "; give one of them another id",
                  task.id.str(), task.where);
    }
    incarnation = {&task, components_.of(task.component), kRuntime, task.id.str()};
    IndexedTask& entry = index_.tasks[as_index(number)];
    if (side == kCurrent) {
      entry.idle = options_.idle.contains(task.id);
      return {};
    }
    index_.target_order.push_back(number);
    if (task.takes_over) entry.takes_over = ids_.find(task.takes_over->str());
    if (options_.prepared.contains(task.id)) mark_prepared(entry, task);
    return {};
  }

  /// The id under which the current network knows the incarnation that `id` means.
  [[nodiscard]] const model::TaskId& id_of(Side side, const model::TaskId& id) const {
    if (side == kCurrent || options_.prepared.empty()) return id;
    const auto found = options_.prepared.find(id);
    return found == options_.prepared.end() ? id : found->second;
  }
  [[nodiscard]] int number_of(Side side, const model::TaskId& id) const {
    return ids_.find(id_of(side, id).str());
  }

  void mark_prepared(IndexedTask& entry, const model::Task& task) {
    entry.prepared = entry.current().task != nullptr;
    entry.replaces = ids_.find(task.id.str());
    if (entry.replaces != kNone) index_.tasks[as_index(entry.replaces)].is_replaced = true;
  }

  /// An error is allowed as target state if the task is in it already.
  [[nodiscard]] bool is_so_now(const model::Task& task) const {
    const int number = number_of(kTarget, task.id);
    if (number == kNone) return false;
    const model::Task* now = index_.task(number).current().task;
    return now != nullptr && now->state == task.state;
  }

  Result<> add_deployments(Side side) {
    for (const model::Deployment& deployment : networks_[side]->deployments) {
      if (auto done = add_deployment(side, deployment); !done) return done;
    }
    return {};
  }

  Result<> add_deployment(Side side, const model::Deployment& deployment) {
    if (deployment.process.empty()) {
      return fail(ErrorCode::InvalidArgument,
                  "a deployment" + of(side) + " on host " + quote(deployment.host.str()) +
                      " has no process name; name it, or leave its tasks out of every deployment",
                  deployment.host.str(), deployment.where);
    }
    const int number = process_number(deployment);
    if (index_.processes[as_index(number)].on[side] != nullptr) {
      return fail(ErrorCode::InvalidArgument,
                  "process " + quote(to_string(deployment.key())) + of(side) +
                      " is deployed twice; join the two deployments or name one differently",
                  to_string(deployment.key()), deployment.where);
    }
    index_.processes[as_index(number)].on[side] = &deployment;
    index_.process_order[side].push_back(number);
    for (const model::Placement& placement : deployment.tasks) {
      if (auto done = place(side, number, placement, deployment.where); !done) return done;
    }
    return {};
  }

  int process_number(const model::Deployment& deployment) {
    const std::size_t hash = std::hash<model::DeploymentKey>{}(deployment.key());
    const int known = processes_.find(hash, [&](int number) {
      const IndexedProcess& entry = index_.processes[as_index(number)];
      const model::Deployment& other = entry.on[kCurrent] ? *entry.on[kCurrent] : *entry.on[kTarget];
      return other.process == deployment.process && other.host == deployment.host;
    });
    if (known != kNone) return known;
    const int number = static_cast<int>(index_.processes.size());
    index_.processes.emplace_back();
    processes_.insert(hash, number);
    return number;
  }

  /// Deployments may name tasks that the network lacks; these placements are empty.
  Result<> place(Side side, int process, const model::Placement& placement, const SourceLocation& where) {
    const int number = number_of(side, placement.task);
    if (number == kNone) return {};
    TaskIncarnation& incarnation = index_.tasks[as_index(number)].on[side];
    if (incarnation.task == nullptr) return {};
    if (incarnation.process != kRuntime) {
      return fail(ErrorCode::InvalidArgument,
                  "task " + quote(placement.task.str()) + of(side) +
                      " has a place in two deployments; leave it in one",
                  placement.task.str(), where);
    }
    incarnation.process = process;
    if (placement.name.empty() || placement.name == placement.task.str()) return {};
    incarnation.name = placement.name;
    index_.tasks_renamed = true;
    return {};
  }

  /// Ids are unique, so two tasks can only have the same placement if names inside processes differ from ids.
  Result<> check_places() const {
    if (!index_.tasks_renamed) return {};
    const OccupantIndex occupants(index_, kTarget);
    for (const int number : index_.target_order) {
      const TaskIncarnation& task = index_.task(number).target();
      const int first = occupants.find(task.process, task.name);
      if (first == number) continue;
      return fail(ErrorCode::InvalidArgument,
                  "tasks " + quote(index_.task(first).target().task->id.str()) + " and " +
                      quote(task.task->id.str()) + " of the target have the same name " + quote(task.name) +
                      " in one process; give one of them another name there",
                  task.task->id.str(), task.task->where);
    }
    return {};
  }

  Result<> add_connections(Side side) {
    index_.connections[side].reserve(networks_[side]->connections.size());
    for (const model::Connection& connection : networks_[side]->connections) {
      if (auto done = add_connection(side, connection); !done) return done;
    }
    return {};
  }

  Result<> add_connection(Side side, const model::Connection& definition) {
    IndexedConnection connection{&definition, end(side, definition.from), end(side, definition.to)};
    if (connection.from == kNone || connection.to == kNone) return unknown_end(side, connection);
    const TaskIncarnation& from = index_.tasks[as_index(connection.from)].on[side];
    const TaskIncarnation& to = index_.tasks[as_index(connection.to)].on[side];
    connection.from_dynamic = is_dynamic(from.component, definition.from.port, model::Direction::Output);
    connection.to_dynamic = is_dynamic(to.component, definition.to.port, model::Direction::Input);
    if (side == kTarget) {
      if (connection.from_dynamic && !is_configured(from)) return no_port(definition, definition.from);
      if (connection.to_dynamic && !is_configured(to)) return no_port(definition, definition.to);
    }
    return match(side, connection);
  }

  [[nodiscard]] int end(Side side, const model::PortRef& ref) const {
    const int number = number_of(side, ref.task);
    return number != kNone && index_.tasks[as_index(number)].on[side].task != nullptr ? number : kNone;
  }

  /// Connections are numbered through: those of the current network first. A connection that was made too
  /// late stands beside the one that was meant for these ports; at most one of them stays.
  Result<> match(Side side, IndexedConnection& connection) {
    std::vector<IndexedConnection>& current = index_.connections[kCurrent];
    std::vector<IndexedConnection>& own = index_.connections[side];
    const std::size_t hash = hash_of_ends(connection);
    const int found = ends_.find(hash, [&](int number) { return same_ends(numbered(number), connection); });
    if (found != kNone && side == kCurrent) {
      surplus_.push_back(static_cast<int>(own.size()));
      own.push_back(connection);
      return {};
    }
    const bool is_current = found != kNone && as_index(found) < current.size();
    if (found != kNone && (!is_current || current[as_index(found)].partner != kNone)) {
      return fail(ErrorCode::InvalidArgument,
                  "two connections" + of(side) + " join the same ports, one is " +
                      quote(to_string(*connection.connection)) + "; keep one of them",
                  to_string(*connection.connection), connection.connection->where);
    }
    if (found == kNone) {
      const std::size_t before = side == kTarget ? current.size() : 0;
      ends_.insert(hash, static_cast<int>(before + own.size()));
    } else {
      prefer_equal(current[as_index(found)], connection);
      connection.partner = found;
      current[as_index(found)].partner = static_cast<int>(own.size());
    }
    own.push_back(connection);
    return {};
  }

  /// Prefers, of several current connections of the same ports, the one with the wanted policy over the
  /// first.
  void prefer_equal(IndexedConnection& first, const IndexedConnection& wanted) {
    if (first.connection->policy == wanted.connection->policy) return;
    for (const int number : surplus_) {
      IndexedConnection& other = index_.connections[kCurrent][as_index(number)];
      if (!same_ends(other, wanted) || other.connection->policy != wanted.connection->policy) continue;
      return std::swap(first, other);
    }
  }

  [[nodiscard]] const IndexedConnection& numbered(int number) const {
    const std::vector<IndexedConnection>& current = index_.connections[kCurrent];
    if (as_index(number) < current.size()) return current[as_index(number)];
    return index_.connections[kTarget][as_index(number) - current.size()];
  }

  static Result<> unknown_end(Side side, const IndexedConnection& indexed) {
    const model::Connection& connection = *indexed.connection;
    const model::TaskId& missing = indexed.from == kNone ? connection.from.task : connection.to.task;
    return fail(ErrorCode::InvalidArgument,
                "connection " + quote(to_string(connection)) + of(side) + " names task " +
                    quote(missing.str()) + ", which does not exist; add the task or remove the connection",
                missing.str(), connection.where);
  }

  static Result<> no_port(const model::Connection& connection, const model::PortRef& ref) {
    return fail(ErrorCode::InvalidArgument,
                "connection " + quote(to_string(connection)) + " of the target needs port " +
                    quote(to_string(ref)) + ", which exists only while its task is configured; ask for the " +
                    "task to be stopped or running, or remove the connection",
                ref.task.str(), connection.where);
  }

  std::array<const model::Network*, 2> networks_;
  const Options& options_;
  KnownComponents components_;
  Interner ids_;
  HashIndex processes_;
  HashIndex ends_;
  std::vector<int> surplus_;  ///< current connections of the same ports as one before
  Index index_;
};

}  // namespace

bool is_configured(const TaskIncarnation& incarnation) {
  return segue::is_configured(incarnation.task->state);
}

OccupantIndex::OccupantIndex(const Index& index, Side side)
    : index_(index), side_(side), occupants_(index.tasks.size()) {
  for (std::size_t i = 0; i < index.tasks.size(); ++i) {
    const TaskIncarnation& task = index.tasks[i].on[side];
    if (task.task != nullptr) occupants_.insert(hash(task.process, task.name), static_cast<int>(i));
  }
}

int OccupantIndex::find(int process, std::string_view name) const {
  return occupants_.find(hash(process, name), [&](int number) {
    const TaskIncarnation& task = index_.task(number).on[side_];
    return task.process == process && task.name == name;
  });
}

std::size_t OccupantIndex::hash(int process, std::string_view name) {
  return model::combine_hashes(std::hash<std::string_view>{}(name), as_index(process));
}

Result<Index> build_index(const model::Network& current, const model::Network& target,
                          const model::ComponentCatalog& catalog, const Options& options) {
  return Builder(current, target, catalog, options).build();
}

}  // namespace segue::solve::detail

// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/model/file_parts.hpp>
#include <segue/model/network_index.hpp>

#include <algorithm>
#include <tuple>
#include <unordered_map>
#include <unordered_set>

namespace segue::model::detail {
namespace {

/// Checks a network; continues after each problem.
class StructureCheck {
 public:
  StructureCheck(const Network& network, const NetworkIndex& index, Diagnostics& diagnostics)
      : network_(network), index_(index), diagnostics_(diagnostics) {}

  void run() {
    wires_.reserve(network_.connections.size());
    deployment_of_.reserve(network_.tasks.size());
    for (const Task& task : network_.tasks)
      check_task(task);
    for (const Deployment& deployment : network_.deployments)
      check_deployment(deployment);
    for (const Task& task : network_.tasks)
      check_thread(task);
    for (const Connection& connection : network_.connections)
      check_connection(connection);
  }

 private:
  void error(std::string code, std::string message, const SourceLocation& where) {
    diagnostics_.error(std::move(code), std::move(message), place(where, network_));
  }
  void warning(std::string code, std::string message, const SourceLocation& where) {
    diagnostics_.warning(std::move(code), std::move(message), place(where, network_));
  }

  void check_identifier(const std::string& name, const std::string& what, const SourceLocation& where) {
    if (is_identifier(name)) return;
    error("bad-name", what + ": " + quote(name) + " is not a name: " + std::string(kIdentifierRule), where);
  }

  void check_task(const Task& task) {
    const std::string what = "task " + quote(task.id.str());
    check_identifier(task.id.str(), "a task", task.where);
    check_identifier(task.component.str(), "the component of " + what, task.where);
    if (const Task* first = index_.task(task.id); first != &task) {
      error("duplicate-task", what + " is defined twice; the first is at " + to_string(first->where),
            task.where);
    }
    if (is_error(task.state)) {
      error("error-state-target",
            what + ": " + std::string(to_string(task.state)) +
                " is not a valid target; ask for pre_operational, stopped or running",
            task.where);
    }
    const auto problem = task.activity ? problem_of(*task.activity) : std::nullopt;
    if (problem) error("bad-activity", what + ": " + *problem, task.where);
    if (!task.properties.is_map()) error("wrong-kind", what + ": its properties must be a map", task.where);
    check_heir(task, what);
  }

  void check_heir(const Task& task, const std::string& what) {
    if (!task.takes_over) return;
    const auto [first, fresh] = heirs_.try_emplace(task.takes_over->str(), &task);
    if (fresh) return;
    error("bad-takes-over",
          what + " and task " + quote(first->second->id.str()) + " both take over from " +
              quote(task.takes_over->str()),
          task.where);
  }

  void check_deployment(const Deployment& deployment) {
    const std::string what = "process " + to_string(deployment.key());
    check_identifier(deployment.process.str(), "a process", deployment.where);
    check_identifier(deployment.host.str(), "the host of " + what, deployment.where);
    const auto [first, fresh] = processes_.try_emplace(deployment.key(), &deployment);
    if (!fresh) {
      error("duplicate-process",
            what + " is defined twice; the first is at " + to_string(first->second->where) +
                ": put their tasks into one",
            deployment.where);
    }
    Activity scheduling;
    scheduling.scheduler = deployment.scheduler;
    scheduling.priority = deployment.priority;
    if (const auto problem = problem_of(scheduling))
      error("bad-priority", what + ": " + *problem, deployment.where);
    if (const auto problem = problem_of(deployment.limits))
      error("bad-limit", what + ": " + *problem, deployment.where);
    std::unordered_set<std::string_view> names;
    for (const Placement& placement : deployment.tasks) {
      check_placement(placement, deployment, what);
      if (!names.insert(placement.name).second) {
        error("duplicate-name", what + " has two tasks named " + quote(placement.name), deployment.where);
      }
    }
  }

  void check_placement(const Placement& placement, const Deployment& deployment, const std::string& what) {
    const std::string task = "task " + quote(placement.task.str());
    const auto [first, fresh] = deployment_of_.try_emplace(placement.task.str(), &deployment);
    if (!fresh) {
      error("task-in-two-deployments",
            task + " is in " + what + " and in process " + to_string(first->second->key()), deployment.where);
    }
    if (index_.task(placement.task) != nullptr) return;
    const std::string text =
        what + " names " + task + ", which the network lacks" + index_.task_suggestion(placement.task.str());
    if (deployment.deployer == kOwnDeployer) return error("unknown-placement", text, deployment.where);
    warning("unknown-placement", text, deployment.where);  // real files of Rock have such
  }

  /// Tasks that share a thread must have equal scheduling.
  void check_thread(const Task& task) {
    if (!task.activity || task.activity->thread.empty()) return;
    const Deployment* holder = index_.deployment(task.id);
    const std::string process = holder == nullptr ? std::string{} : to_string(holder->key());
    const auto [first, fresh] = threads_.try_emplace(process + '\n' + task.activity->thread, &task);
    auto scheduling = [](const Task& t) {
      return std::tie(t.activity->scheduler, t.activity->priority, t.activity->cpus);
    };
    if (fresh || scheduling(task) == scheduling(*first->second)) return;
    error("thread-conflict",
          "tasks " + quote(first->second->id.str()) + " and " + quote(task.id.str()) + " share the thread " +
              quote(task.activity->thread) + " but differ in scheduler, priority or cpu",
          task.where);
  }

  static std::string name_of(const Connection& connection) { return "connection " + to_string(connection); }

  void check_connection(const Connection& connection) {
    check_end(connection.from, Direction::Output, connection);
    check_end(connection.to, Direction::Input, connection);
    if (connection.policy.size == 0) {
      error("bad-size", name_of(connection) + ": a buffer of size 0 holds nothing", connection.where);
    }
    const auto [found, fresh] = wires_.insert(&connection);
    if (fresh) return;
    const Connection& first = **found;
    const bool same = first.policy == connection.policy;
    error("duplicate-connection",
          name_of(connection) + (same ? " is defined twice" : " has the same ends as " + to_string(first)) +
              "; the first is at " + to_string(first.where),
          connection.where);
  }

  void check_end(const PortRef& end, Direction direction, const Connection& connection) {
    const Task* task = index_.task(end.task);
    if (task == nullptr) {
      const std::string suggestion = index_.task_suggestion(end.task.str());
      error("unknown-task",
            name_of(connection) + ": the network has no task " + quote(end.task.str()) +
                (suggestion.empty() ? "; is it a template, meant to be merged with another network?"
                                    : suggestion),
            connection.where);
      return;
    }
    if (!is_identifier(end.port)) check_identifier(end.port, name_of(connection), connection.where);
    if (task->state != TaskState::PreOperational) return;
    const ComponentIndex* component = index_.component(task->component);
    if (component == nullptr) return;
    const auto ports = component->find_ports(end.port, direction);
    if (ports.empty() || !ports.front()->dynamic) return;
    error("unconfigured-dynamic-port",
          name_of(connection) + ": port " + quote(end.port) + " exists only once task " +
              quote(end.task.str()) + " is configured, but its target is " +
              std::string(to_string(task->state)),
          connection.where);
  }

  struct SameEnds {
    std::size_t operator()(const Connection* c) const noexcept {
      return combine_hashes(std::hash<PortRef>{}(c->from), std::hash<PortRef>{}(c->to));
    }
    bool operator()(const Connection* a, const Connection* b) const {
      return a->from == b->from && a->to == b->to;
    }
  };

  const Network& network_;
  const NetworkIndex& index_;
  Diagnostics& diagnostics_;
  std::unordered_map<std::string_view, const Task*> heirs_;
  std::unordered_map<DeploymentKey, const Deployment*> processes_;
  std::unordered_map<std::string_view, const Deployment*> deployment_of_;
  std::unordered_map<std::string, const Task*> threads_;
  std::unordered_set<const Connection*, SameEnds, SameEnds> wires_;
};

}  // namespace

void check_structure(const Network& network, const NetworkIndex& index, Diagnostics& diagnostics) {
  StructureCheck(network, index, diagnostics).run();
}

}  // namespace segue::model::detail

// SPDX-License-Identifier: Apache-2.0
#include <segue/solve/simulation.hpp>

#include <segue/base/text.hpp>
#include <segue/solve/call_check.hpp>
#include <segue/solve/component_facts.hpp>
#include <segue/solve/plan.hpp>
#include <segue/solve/transition_index.hpp>

#include <algorithm>

namespace segue::solve::detail {

namespace {

using model::ActionKind;

Error refuse(std::string message) {
  return fail(ErrorCode::InvalidState, std::move(message));
}

std::string state_of(const model::TaskId& id, TaskState state) {
  return "task " + quote(id.str()) + " is in state " + std::string(to_string(state));
}

}  // namespace

Result<Simulation> Simulation::create(const model::Network& current, const model::ComponentCatalog& catalog) {
  auto index = build_index(current, {}, catalog, {});
  if (!index) return index.error();
  Simulation simulation(catalog, std::move(index->ids));
  for (const int process : index->process_order[kCurrent]) {
    if (auto done = simulation.deploy(*index->process(process).current()); !done) return done.error();
  }
  simulation.tasks_.reserve(index->tasks.size());
  for (const IndexedTask& entry : index->tasks) {
    const auto& incarnation = entry.current();
    const int number = simulation.add_task(*incarnation.task, incarnation.process, incarnation.name);
    simulation.task(number).state = incarnation.task->state;
    if (!is_configured(incarnation) && incarnation.task->state != TaskState::Fatal) continue;
    for (const std::string& device : simulation.devices_of(number))
      simulation.holders_[device] = number;
  }
  simulation.connections_.reserve(index->connections[kCurrent].size());
  for (const auto& connection : index->connections[kCurrent]) {
    if (exists(*index, connection))
      simulation.add_connection(*connection.connection, connection.from, connection.to);
  }
  return simulation;
}

Result<> Simulation::execute(const model::Action& action) {
  switch (action.kind) {
    case ActionKind::Disconnect:
      if (const auto* what = std::get_if<model::ConnectionAction>(&action.what))
        return disconnect(what->connection);
      break;
    case ActionKind::Connect:
      if (const auto* what = std::get_if<model::ConnectionAction>(&action.what))
        return connect(what->connection);
      break;
    case ActionKind::Undeploy:
      if (const auto* what = std::get_if<model::DeploymentAction>(&action.what)) return undeploy(*what);
      break;
    case ActionKind::Deploy:
      if (const auto* what = std::get_if<model::DeploymentAction>(&action.what))
        return deploy(what->deployment);
      break;
    case ActionKind::ApplyConfig:
      if (const auto* what = std::get_if<model::ConfigAction>(&action.what)) return apply(*what);
      break;
    case ActionKind::HandOver:
      if (const auto* what = std::get_if<model::HandOverAction>(&action.what)) return hand_over(*what);
      break;
    case ActionKind::CallOperation:
      if (const auto* what = std::get_if<model::CallAction>(&action.what)) return call(*what);
      break;
    default:
      if (action.task() != nullptr) return change_state(action);
  }
  return fail(ErrorCode::InvalidArgument, "the action names no subject");
}

Result<> Simulation::change_state(const model::Action& action) {
  const int number = subject_of(action);
  if (number == kNone) return refuse("there is no task " + quote(action.task()->str()));
  TaskState& state = task(number).state;
  const TaskState before = state;
  const auto from = [&](std::initializer_list<TaskState> allowed) {
    return std::find(allowed.begin(), allowed.end(), before) != allowed.end();
  };
  using enum TaskState;
  if (action.kind == ActionKind::Recover && from({RunTimeError, Exception})) {
    state = before == RunTimeError ? Running : PreOperational;
    return {};
  }
  if (action.kind == ActionKind::Stop && from({Running, RunTimeError})) {
    state = Stopped;
    return {};
  }
  if (action.kind == ActionKind::Start && from({Stopped})) {
    state = Running;
    return {};
  }
  if (action.kind == ActionKind::Cleanup && from({Stopped})) return leave_configured(number);
  if (action.kind == ActionKind::Configure && from({PreOperational})) return claim_devices(number);
  return refuse(state_of(*action.task(), before) + ", which does not allow " +
                std::string(to_string(action.kind)));
}

Result<> Simulation::call(const model::CallAction& action) const {
  const int number = find_newest(action.task);
  if (number == kNone) return refuse("there is no task " + quote(action.task.str()));
  const auto* component = task(number).component.model;
  return component == nullptr ? Result<>() : check_call(action, *component, components_.types());
}

Result<> Simulation::hand_over(const model::HandOverAction& action) const {
  const int from = find_going(action.from);
  const int to = find_newest(action.to);
  if (from == kNone) return refuse("there is no task " + quote(action.from.str()));
  if (to == kNone) return refuse("there is no task " + quote(action.to.str()));
  if (from == to)
    return refuse("task " + quote(action.to.str()) + " has no other incarnation to take over from");
  for (const int end : {from, to}) {
    if (task(end).state == TaskState::Stopped) continue;
    return refuse(state_of(task(end).definition->id, task(end).state) +
                  ", but a state is handed over between tasks that are stopped");
  }
  return {};
}

/// Removes the connections of dynamic ports, which vanish.
Result<> Simulation::leave_configured(int number) {
  task(number).state = TaskState::PreOperational;
  release_devices(number);
  const ComponentFacts& component = task(number).component;
  if (!component.dynamic) return {};
  for (int i = task(number).first_connection; i != kNone; i = next_connection(i, number)) {
    const StoredConnection& stored = connections_[as_index(i)];
    const model::Connection& connection = *stored.connection;
    if (!stored.exists) continue;
    const bool from =
        stored.from == number && is_dynamic(component, connection.from.port, model::Direction::Output);
    const bool to = stored.to == number && is_dynamic(component, connection.to.port, model::Direction::Input);
    if (from || to) drop_connection(i);
  }
  return {};
}

Result<> Simulation::claim_devices(int number) {
  const std::vector<std::string> devices = devices_of(number);
  for (const std::string& device : devices) {
    const auto holder = holders_.find(device);
    if (holder == holders_.end() || holder->second == number) continue;
    return refuse("device " + quote(device) + " of task " + quote(task(number).definition->id.str()) +
                  " is still held by task " + quote(task(holder->second).definition->id.str()));
  }
  for (const std::string& device : devices)
    holders_[device] = number;
  task(number).state = TaskState::Stopped;
  return {};
}

Result<> Simulation::connect(const model::Connection& connection) {
  const int from = find_newest(connection.from.task);
  const int to = find_newest(connection.to.task);
  if (from == kNone) return refuse("there is no task " + quote(connection.from.task.str()));
  if (to == kNone) return refuse("there is no task " + quote(connection.to.task.str()));
  const auto lacks = [&](int end, const std::string& port, model::Direction direction) {
    return !segue::is_configured(task(end).state) && is_dynamic(task(end).component, port, direction);
  };
  if (lacks(from, connection.from.port, model::Direction::Output)) {
    return refuse("port " + quote(to_string(connection.from)) + " exists only when its task is configured");
  }
  if (lacks(to, connection.to.port, model::Direction::Input)) {
    return refuse("port " + quote(to_string(connection.to)) + " exists only when its task is configured");
  }
  for (const int number : connections_between(connection)) {
    const StoredConnection& stored = connections_[as_index(number)];
    if (stored.from == from && stored.to == to && stored.connection->policy == connection.policy) {
      return refuse("the two ports are connected already: " + quote(to_string(*stored.connection)));
    }
  }
  add_connection(connection, from, to);
  return {};
}

Result<> Simulation::disconnect(const model::Connection& connection) {
  int found = kNone;
  for (const int number : connections_between(connection)) {
    const StoredConnection& stored = connections_[as_index(number)];
    if (stored.connection->policy != connection.policy) continue;
    const bool is_going = !is_newest(stored.from) || !is_newest(stored.to);
    if (found == kNone || is_going) found = number;
  }
  if (found == kNone) return refuse("there is no connection " + quote(to_string(connection)));
  drop_connection(found);
  return {};
}

Result<> Simulation::deploy(const model::Deployment& deployment) {
  const int known = find_process(deployment.key());
  if (deployment.process.empty()) return refuse("the runtime's own process cannot be deployed");
  if (known != kNone) return refuse("process " + quote(to_string(deployment.key())) + " runs already");
  process_numbers_.insert(std::hash<model::DeploymentKey>{}(deployment.key()),
                          static_cast<int>(processes_.size()));
  processes_.push_back({&deployment, true, {}});
  return {};
}

Result<> Simulation::undeploy(const model::DeploymentAction& action) {
  const model::Deployment& deployment = action.deployment;
  const int number = find_process(deployment.key());
  if (deployment.process.empty()) return refuse("the runtime's own process cannot be undeployed");
  if (number == kNone) return refuse("process " + quote(to_string(deployment.key())) + " does not run");
  Process& process = processes_[as_index(number)];
  for (const int resident : process.tasks) {
    if (action.kill) break;
    if (!task(resident).exists || !segue::is_configured(task(resident).state)) continue;
    return refuse(state_of(task(resident).definition->id, task(resident).state) +
                  "; stop it and clean it up before its process is undeployed");
  }
  for (const int resident : process.tasks)
    drop_task(resident);
  process.running = false;
  return {};
}

Result<> Simulation::apply(const model::ConfigAction& action) {
  const int process = find_process(action.process);
  if (process == kNone) return refuse("process " + quote(to_string(action.process)) + " does not run");
  const int newest = find_newest(action.definition.id);
  const int occupant = find_occupant(process, action.name);
  if (occupant != kNone && occupant == newest &&
      task(newest).definition->component == action.definition.component) {
    return apply_again(newest, action);
  }
  if (occupant != kNone) {
    if (auto done = take_place(occupant, process, action); !done) return done;
  }
  if (newest != kNone) {
    if (auto done = make_going(pairs_[as_index(task(newest).id)]); !done) return done;
  }
  add_task(action.definition, process, action.name);
  return {};
}

/// The incarnation stays: it must be unconfigured, unless only live properties change.
Result<> Simulation::apply_again(int number, const model::ConfigAction& action) {
  Instance& known = task(number);
  const bool rests = known.state == TaskState::PreOperational;
  const bool live = segue::is_configured(known.state) &&
                    (known.definition->same_configuration(action.definition) ||
                     differ_only_live(*known.definition, action.definition, known.component.model));
  if (!rests && !live) {
    return refuse(state_of(action.definition.id, known.state) +
                  ", in which only live properties can be applied");
  }
  known.definition = &action.definition;
  return {};
}

/// A new incarnation replaces the occupant of its placement.
Result<> Simulation::take_place(int occupant, int process, const model::ConfigAction& action) {
  const Instance& other = task(occupant);
  if (!is_resting(occupant)) {
    return refuse(state_of(other.definition->id, other.state) + " or connected, and " +
                  quote(action.definition.id.str()) + " is to take its place");
  }
  const bool fits = other.definition->component == action.definition.component;
  if (process != kRuntime && !fits && !holds_any_component(*processes_[as_index(process)].deployment)) {
    return refuse("process " + quote(to_string(action.process)) + " cannot hold another component as " +
                  quote(action.name) + "; redeploy it");
  }
  drop_task(occupant);
  return {};
}

/// The newest incarnation becomes the old one.
Result<> Simulation::make_going(Pair& pair) {
  if (pair.newest == kNone || !task(pair.newest).exists) return {};
  if (pair.going != kNone && task(pair.going).exists && !is_resting(pair.going)) {
    return refuse("task " + quote(task(pair.going).definition->id.str()) + " has two incarnations already");
  }
  pair.going = pair.newest;
  return {};
}

}  // namespace segue::solve::detail

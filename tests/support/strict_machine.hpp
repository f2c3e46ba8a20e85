// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/component_model.hpp>
#include <segue/model/network.hpp>
#include <segue/model/transition.hpp>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

/// An independent check of transitions: a simulated robot that is stricter than any real one and shares no
/// code with the solver. It refuses the first action that is not graceful: cleaning up while a connection
/// would be lost, undeploying a process with connections or running tasks, starting a task twice or with an
/// old configuration, two holders of a device, two equal connections; and, as an option, a
/// task in two processes. Slow and simple on purpose.
namespace segue::testing {

class StrictMachine {
 public:
  StrictMachine(const model::Network& current, const model::Network& target,
                const model::ComponentCatalog& catalog, bool side_by_side = true)
      : catalog_(catalog), side_by_side_(side_by_side) {
    for (const auto& task : target.tasks)
      wanted_.emplace(task.id.str(), task);
    for (const auto& deployment : current.deployments)
      processes_.emplace(deployment.key(), deployment);
    for (const auto& task : current.tasks)
      settle(current, task);
    for (const auto& connection : current.connections) {
      Wire wire{connection, bodies_.at(connection.from.task.str()).front(),
                bodies_.at(connection.to.task.str()).front()};
      if (!needs_port_that_is_gone(wire)) wires_.push_back(wire);
    }
  }

  /// The rule that the action violates, or empty.
  std::string execute(const model::Action& action) {
    using model::ActionKind;
    switch (action.kind) {
      case ActionKind::Deploy:
        return deploy(std::get<model::DeploymentAction>(action.what).deployment);
      case ActionKind::Undeploy:
        return undeploy(std::get<model::DeploymentAction>(action.what));
      case ActionKind::Connect:
        return connect(std::get<model::ConnectionAction>(action.what).connection);
      case ActionKind::Disconnect:
        return disconnect(std::get<model::ConnectionAction>(action.what).connection);
      case ActionKind::ApplyConfig:
        return apply(std::get<model::ConfigAction>(action.what));
      case ActionKind::HandOver:
        return hand_over(std::get<model::HandOverAction>(action.what));
      case ActionKind::CallOperation:
        return "";
      default:
        return step(action.kind, action.task()->str());
    }
  }

  /// The first difference between the running network and the target, or empty.
  std::string finish(const model::Transition& transition, const model::Network& target) {
    for (const auto& task : transition.redefines) {
      Body& body = at(newest(task.id.str()));
      if (!(body.task.properties == task.properties)) return task.id.str() + ": redefined without an action";
      body.task = task;
    }
    model::Network result;
    for (const auto& [place, body] : tasks_) {
      const std::string id = body.task.id.str();
      const bool idle = body.state == TaskState::PreOperational && !is_wired(place);
      if (wanted_.contains(id) && newest(id) == place) {
        result.tasks.push_back(body.task);
        result.tasks.back().state = body.state;
      } else if (!idle) {
        return id + ": left behind, not at rest";
      }
    }
    for (const auto& [key, deployment] : processes_) {
      result.deployments.push_back(deployment);
      auto& placements = result.deployments.back().tasks;
      placements.clear();
      for (const auto& [place, body] : tasks_) {
        if (place.first == key && wanted_.contains(body.task.id.str()) &&
            newest(body.task.id.str()) == place) {
          placements.push_back({body.task.id, place.second});
        }
      }
    }
    for (const Wire& wire : wires_)
      result.connections.push_back(wire.connection);
    const auto found = model::differences(result, target);
    return found.empty() ? "" : found.front();
  }

 private:
  using Place = std::pair<model::DeploymentKey, std::string>;
  struct Body {
    model::Task task;
    TaskState state;
  };
  struct Wire {
    model::Connection connection;
    Place from;
    Place to;
  };

  void settle(const model::Network& network, const model::Task& task) {
    Place place{{}, task.id.str()};
    for (const auto& deployment : network.deployments) {
      for (const auto& placement : deployment.tasks) {
        if (placement.task == task.id) place = {deployment.key(), placement.name};
      }
    }
    tasks_.emplace(place, Body{task, task.state});
    bodies_[task.id.str()].push_back(place);
  }

  Body& at(const Place& place) { return tasks_.at(place); }
  [[nodiscard]] const Place& newest(const std::string& id) const { return bodies_.at(id).back(); }
  [[nodiscard]] bool exists(const std::string& id) const {
    const auto found = bodies_.find(id);
    return found != bodies_.end() && !found->second.empty();
  }
  static bool configured(TaskState state) {
    return state == TaskState::Stopped || state == TaskState::Running || state == TaskState::RunTimeError;
  }
  [[nodiscard]] bool is_wired(const Place& place) const {
    return std::any_of(wires_.begin(), wires_.end(),
                       [&](const Wire& wire) { return wire.from == place || wire.to == place; });
  }

  bool is_dynamic(const Place& place, const std::string& port) {
    const auto* model = catalog_.find(at(place).task.component);
    if (model == nullptr) return false;
    for (const auto& candidate : model->ports) {
      const bool family = candidate.pattern && port.starts_with("dyn_");
      if (family || candidate.name == port) return candidate.dynamic || candidate.pattern;
    }
    return false;
  }
  bool needs_port_that_is_gone(const Wire& wire) {
    return (!configured(at(wire.from).state) && is_dynamic(wire.from, wire.connection.from.port)) ||
           (!configured(at(wire.to).state) && is_dynamic(wire.to, wire.connection.to.port));
  }

  std::set<std::string> devices(const Place& place) {
    const model::Task& task = at(place).task;
    std::set<std::string> found(task.exclusive.begin(), task.exclusive.end());
    if (const auto* model = catalog_.find(task.component)) {
      found.insert(model->exclusive.begin(), model->exclusive.end());
    }
    std::set<std::string> here;  // the same name on another host is another device
    const model::HostName& host = place.first.is_runtime() ? model::kLocalHost : place.first.host;
    for (const std::string& device : found)
      here.insert(host.str() + ' ' + device);
    return here;
  }

  std::string deploy(const model::Deployment& deployment) {
    if (!deployment.tasks.empty()) return "deploy names tasks";
    return processes_.emplace(deployment.key(), deployment).second ? "" : "process runs already";
  }

  std::string undeploy(const model::DeploymentAction& action) {
    const model::Deployment& deployment = action.deployment;
    if (!processes_.contains(deployment.key())) return "no such process";
    if (action.kill) {
      std::erase_if(wires_, [&](const Wire& wire) {
        return wire.from.first == deployment.key() || wire.to.first == deployment.key();
      });
    }
    for (const auto& [place, body] : tasks_) {
      if (place.first != deployment.key() || action.kill) continue;
      if (configured(body.state)) return body.task.id.str() + " is configured when its process is undeployed";
      if (is_wired(place)) return body.task.id.str() + " is connected when its process is undeployed";
    }
    std::erase_if(tasks_, [&](const auto& task) { return task.first.first == deployment.key(); });
    for (auto& [id, places] : bodies_) {
      std::erase_if(places, [&](const Place& place) { return place.first == deployment.key(); });
    }
    processes_.erase(deployment.key());
    return "";
  }

  std::string connect(const model::Connection& connection) {
    if (!exists(connection.from.task.str()) || !exists(connection.to.task.str())) return "no such task";
    const Wire wire{connection, newest(connection.from.task.str()), newest(connection.to.task.str())};
    if (needs_port_that_is_gone(wire)) return "no such port yet";
    for (const Wire& other : wires_) {
      const bool same_ports =
          other.connection.from == connection.from && other.connection.to == connection.to;
      const bool same_ends = other.from == wire.from && other.to == wire.to;
      if (same_ports && same_ends && other.connection.policy == connection.policy) return "connected already";
    }
    for (const Place& place : {wire.from, wire.to}) {
      if (at(place).state == TaskState::Running && began_here_.contains(place))
        return "started before its wire";
    }
    wires_.push_back(wire);
    return "";
  }

  std::string disconnect(const model::Connection& connection) {
    const auto found = std::find_if(wires_.begin(), wires_.end(),
                                    [&](const Wire& wire) { return wire.connection == connection; });
    if (found == wires_.end()) return "no such wire";
    wires_.erase(found);  // the oldest: the new one, if any, was laid later
    return "";
  }

  std::string apply(const model::ConfigAction& action) {
    const Place place{action.process, action.name};
    const std::string id = action.definition.id.str();
    if (!action.process.is_runtime() && !processes_.contains(action.process)) return "no such process";
    if (const auto occupant = tasks_.find(place); occupant != tasks_.end()) {
      const model::Task& there = occupant->second.task;
      if (there.id == action.definition.id && there.component == action.definition.component) {
        return apply_in_place(occupant->second, action.definition);
      }
      if (occupant->second.state != TaskState::PreOperational || is_wired(place)) return "the place is taken";
      const bool foreign = !action.process.is_runtime() && processes_.at(action.process).deployer != "segue";
      if (foreign && there.component != action.definition.component) return "process has no such component";
      std::erase(bodies_[there.id.str()], place);
    }
    for (const Place& other : bodies_[id]) {
      if (other.first == place.first && configured(at(other).state)) return "id is at work in that process";
      const bool at_rest = at(other).state == TaskState::PreOperational && !is_wired(other);
      if (!side_by_side_ && !at_rest) return "id is there already";
    }
    tasks_.insert_or_assign(place, Body{action.definition, TaskState::PreOperational});
    bodies_[id].push_back(place);
    return applied_.insert(id).second ? "" : "configuration applied twice";
  }

  std::string apply_in_place(Body& body, const model::Task& task) {
    if (!applied_.insert(task.id.str()).second) return "configuration applied twice";
    if (configured(body.state) && !only_live_differs(body.task, task)) return "configuration applied at work";
    if (is_error(body.state) && !configured(body.state)) return "configuration applied in error";
    body.task = task;
    return "";
  }

  bool only_live_differs(const model::Task& a, const model::Task& b) {
    const auto* model = catalog_.find(a.component);
    if (model == nullptr || a.config_names != b.config_names || a.exclusive != b.exclusive) return false;
    if (!(a.activity == b.activity)) return false;
    model::Task c = a;
    model::Task d = b;
    for (const auto& property : model->properties) {
      if (!property.live) continue;
      c.properties.as_map().erase(property.name);
      d.properties.as_map().erase(property.name);
    }
    return c.properties == d.properties;
  }

  std::string hand_over(const model::HandOverAction& action) {
    if (!exists(action.from.str()) || !exists(action.to.str())) return "no task to hand over to or from";
    const Place from = bodies_.at(action.from.str()).front();
    const Place to = newest(action.to.str());
    if (from == to) return "handed over to itself";
    if (at(from).state != TaskState::Stopped) return action.from.str() + " is not stopped to hand over";
    if (at(to).state != TaskState::Stopped) return action.to.str() + " is not ready to take over";
    if (wanted_.at(action.to.str()).takes_over != action.from) return "the hand-over was not requested";
    return handed_over_.insert(action.to.str()).second ? "" : "handed over twice";
  }

  std::string step(model::ActionKind kind, const std::string& id) {
    if (!exists(id)) return id + " does not exist";
    using model::ActionKind;
    const bool comes = kind == ActionKind::Configure || kind == ActionKind::Start;
    const auto& places = bodies_.at(id);
    const bool first_rests = at(places.front()).state == TaskState::PreOperational;
    const Place place = comes || first_rests ? places.back() : places.front();
    Body& body = at(place);
    switch (kind) {
      case ActionKind::Recover:
        return recover(body);
      case ActionKind::Stop:
        if (body.state != TaskState::Running && body.state != TaskState::RunTimeError)
          return id + " does not run";
        body.state = TaskState::Stopped;
        return "";
      case ActionKind::Cleanup:
        return clean_up(place, body);
      case ActionKind::Configure:
        return configure(place, body);
      default:
        return start(place, body);
    }
  }

  static std::string recover(Body& body) {
    if (body.state != TaskState::RunTimeError && body.state != TaskState::Exception)
      return "nothing to recover";
    body.state = body.state == TaskState::RunTimeError ? TaskState::Running : TaskState::PreOperational;
    return "";
  }

  std::string clean_up(const Place& place, Body& body) {
    if (body.state != TaskState::Stopped) return "cleanup of what is not stopped";
    for (const Wire& wire : wires_) {
      const bool from = wire.from == place && is_dynamic(place, wire.connection.from.port);
      const bool to = wire.to == place && is_dynamic(place, wire.connection.to.port);
      if (from || to) return "cleanup under a wire";
    }
    body.state = TaskState::PreOperational;
    return "";
  }

  std::string configure(const Place& place, Body& body) {
    if (body.state != TaskState::PreOperational) return "configure of what is not pre-operational";
    const auto mine = devices(place);
    for (const auto& [other, theirs] : tasks_) {
      if (other == place || (!configured(theirs.state) && theirs.state != TaskState::Fatal)) continue;
      for (const auto& device : devices(other)) {
        if (mine.contains(device)) return "device " + device + " is not free";
      }
    }
    body.state = TaskState::Stopped;
    return "";
  }

  std::string start(const Place& place, Body& body) {
    const std::string id = body.task.id.str();
    if (body.state != TaskState::Stopped) return "start of what is not stopped";
    if (!wanted_.at(id).same_configuration(body.task)) return "start with an old configuration";
    for (const Place& other : bodies_.at(id)) {
      const TaskState state = at(other).state;
      if (other != place && (state == TaskState::Running || state == TaskState::RunTimeError)) {
        return "two incarnations of " + id + " run";
      }
    }
    body.state = TaskState::Running;
    began_here_.insert(place);
    return "";
  }

  const model::ComponentCatalog& catalog_;
  bool side_by_side_;
  std::map<std::string, model::Task> wanted_;
  std::map<model::DeploymentKey, model::Deployment> processes_;
  std::map<Place, Body> tasks_;
  std::map<std::string, std::vector<Place>> bodies_;  ///< per task, the older first
  std::vector<Wire> wires_;
  std::set<std::string> applied_;
  std::set<std::string> handed_over_;
  std::set<Place> began_here_;
};

}  // namespace segue::testing

// SPDX-License-Identifier: Apache-2.0
#include <segue/solve/action_sites.hpp>

#include <string>
#include <unordered_map>

namespace segue::solve {

namespace {

using model::ActionKind;
using model::DeploymentKey;
using model::TaskId;

struct TaskPlace {
  std::string component;
  DeploymentKey process;
};
using Incarnations = std::unordered_map<TaskId, TaskPlace>;

Incarnations running_in(const model::Network& network) {
  Incarnations found;
  for (const model::Task& task : network.tasks)
    found[task.id].component = task.component.str();
  for (const model::Deployment& deployment : network.deployments) {
    for (const model::Placement& placement : deployment.tasks) {
      const auto task = found.find(placement.task);
      if (task != found.end()) task->second.process = deployment.key();
    }
  }
  return found;
}

Incarnations created_by(const model::Transition& transition) {
  Incarnations created;
  for (const model::Action& action : transition.actions) {
    if (const auto* config = std::get_if<model::ConfigAction>(&action.what)) {
      created[config->definition.id] = {config->definition.component.str(), config->process};
    }
  }
  return created;
}

/// These kinds of action concern the old incarnation, all others the new one.
bool concerns_old(ActionKind kind) {
  return kind == ActionKind::Recover || kind == ActionKind::Stop || kind == ActionKind::Disconnect ||
         kind == ActionKind::Cleanup;
}

class SiteFinder {
 public:
  SiteFinder(const model::Network& current, const model::Transition& transition)
      : old_(running_in(current)), new_(created_by(transition)) {}

  [[nodiscard]] ActionSite site_of(const model::Action& action) const {
    if (const auto* process = std::get_if<model::DeploymentAction>(&action.what)) {
      const model::Deployment& deployment = process->deployment;
      return {{deployment.deployer, action.kind, deployment.host}, deployment.process};
    }
    if (const auto* connection = std::get_if<model::ConnectionAction>(&action.what)) {
      const TaskPlace& from = find(connection->connection.from.task, action.kind);
      const TaskPlace& to = find(connection->connection.to.task, action.kind);
      const bool within = from.process == to.process;
      return site(std::string(within ? model::kWithinProcess : model::kBetweenProcesses), action.kind,
                  to.process);
    }
    if (action.task() == nullptr) return site("", action.kind, {});
    const TaskPlace& task = find(*action.task(), action.kind);
    const auto* call = std::get_if<model::CallAction>(&action.what);
    return site(call == nullptr ? task.component : task.component + '.' + call->operation, action.kind,
                task.process);
  }

 private:
  static ActionSite site(std::string component, ActionKind kind, const DeploymentKey& process) {
    const bool here = process.host.empty();
    return {{std::move(component), kind, here ? model::kLocalHost : process.host}, process.process};
  }

  [[nodiscard]] const TaskPlace& find(const TaskId& id, ActionKind kind) const {
    static const TaskPlace unknown;
    const bool old_first = concerns_old(kind);
    for (const Incarnations* known : {old_first ? &old_ : &new_, old_first ? &new_ : &old_}) {
      const auto found = known->find(id);
      if (found != known->end()) return found->second;
    }
    return unknown;
  }

  Incarnations old_;
  Incarnations new_;
};

}  // namespace

std::vector<ActionSite> action_sites(const model::Network& current, const model::Transition& transition) {
  const SiteFinder finder(current, transition);
  std::vector<ActionSite> sites;
  sites.reserve(transition.actions.size());
  for (const model::Action& action : transition.actions)
    sites.push_back(finder.site_of(action));
  return sites;
}

}  // namespace segue::solve

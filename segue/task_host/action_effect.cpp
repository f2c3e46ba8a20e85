// SPDX-License-Identifier: Apache-2.0
#include <segue/task_host/action_effect.hpp>

#include <algorithm>

namespace segue::task_host {

namespace {

bool task_is(const model::Network& observed, const model::Action& action, TaskState state) {
  const model::Task* task = observed.find_task(*action.task());
  return task != nullptr && task->state == state;
}

bool has_deployment(const model::Network& observed, const model::Action& action) {
  const auto& wanted = std::get<model::DeploymentAction>(action.what).deployment;
  return std::any_of(observed.deployments.begin(), observed.deployments.end(),
                     [&](const model::Deployment& deployment) { return deployment.key() == wanted.key(); });
}

bool has_connection(const model::Network& observed, const model::Action& action) {
  const auto& wanted = std::get<model::ConnectionAction>(action.what).connection;
  return std::find(observed.connections.begin(), observed.connections.end(), wanted) !=
         observed.connections.end();
}

}  // namespace

bool took_effect(const model::Action& action, const model::Network& observed) {
  switch (action.kind) {
    case model::ActionKind::Stop:
    case model::ActionKind::Configure:
      return task_is(observed, action, TaskState::Stopped);
    case model::ActionKind::Cleanup:
      return task_is(observed, action, TaskState::PreOperational);
    case model::ActionKind::Start:
      return task_is(observed, action, TaskState::Running);
    case model::ActionKind::Deploy:
      return has_deployment(observed, action);
    case model::ActionKind::Undeploy:
      return !has_deployment(observed, action);
    case model::ActionKind::Connect:
      return has_connection(observed, action);
    case model::ActionKind::Disconnect:
      return !has_connection(observed, action);
    default:
      return false;
  }
}

}  // namespace segue::task_host

// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/left_actions.hpp>

#include <algorithm>
#include <variant>

namespace segue::runtime::detail {

namespace {

/// With its connections.
void remove_task(const model::TaskId& id, model::Network& network) {
  std::erase_if(network.tasks, [&](const model::Task& task) { return task.id == id; });
  std::erase_if(network.connections, [&](const model::Connection& connection) {
    return connection.from.task == id || connection.to.task == id;
  });
}

}  // namespace

void LeftActions::close() {
  const std::lock_guard lock(changed_mutex_);
  changed_ = {};
}

void LeftActions::add(const model::Action& action) {
  const std::lock_guard lock(mutex_);
  actions_.push_back(action);
}

void LeftActions::ended(const model::Action& action) {
  {
    const std::lock_guard lock(mutex_);
    const auto found = std::ranges::find(actions_, action);
    if (found != actions_.end()) {
      actions_.erase(found);
    }
  }
  const std::lock_guard lock(changed_mutex_);
  if (changed_) {
    changed_();
  }
}

bool LeftActions::any() const {
  const std::lock_guard lock(mutex_);
  return !actions_.empty();
}

model::Network LeftActions::without_their_processes(model::Network observed) const {
  const std::lock_guard lock(mutex_);
  for (const model::Action& action : actions_) {
    const auto* what = std::get_if<model::DeploymentAction>(&action.what);
    if (what == nullptr) {
      continue;
    }
    std::erase_if(observed.deployments, [&](const model::Deployment& one) {
      const bool is_it = one.key() == what->deployment.key();
      for (const auto& placement : one.tasks) {
        if (is_it) {
          remove_task(placement.task, observed);
        }
      }
      return is_it;
    });
  }
  return observed;
}

bool LeftActions::concern(const NetworkParts& parts) const {
  const std::lock_guard lock(mutex_);
  return std::ranges::any_of(actions_,
                             [&](const model::Action& action) { return !parts.are_independent_of(action); });
}

}  // namespace segue::runtime::detail

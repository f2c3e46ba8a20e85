// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/left_actions.hpp>

#include <algorithm>
#include <set>
#include <variant>

namespace segue::runtime::detail {

void LeftActions::close() {
  const Lock lock(changed_mutex_);
  changed_ = {};
}

void LeftActions::add(const model::Action& action) {
  const Lock lock(mutex_);
  actions_.push_back(action);
}

void LeftActions::ended(const model::Action& action) {
  {
    const Lock lock(mutex_);
    const auto found = std::ranges::find(actions_, action);
    if (found != actions_.end()) {
      actions_.erase(found);
    }
  }
  const Lock lock(changed_mutex_);
  if (changed_) {
    changed_();
  }
}

bool LeftActions::any() const {
  const Lock lock(mutex_);
  return !actions_.empty();
}

model::Network LeftActions::without_their_processes(model::Network observed) const {
  std::set<model::DeploymentKey> processes;
  {
    const Lock lock(mutex_);
    for (const model::Action& action : actions_) {
      if (const auto* what = std::get_if<model::DeploymentAction>(&action.what)) {
        processes.insert(what->deployment.key());
      }
    }
  }
  return without_processes(std::move(observed), processes);
}

bool LeftActions::concern(const NetworkParts& parts) const {
  const Lock lock(mutex_);
  return std::ranges::any_of(actions_,
                             [&](const model::Action& action) { return !parts.are_independent_of(action); });
}

}  // namespace segue::runtime::detail

// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/left_actions.hpp>

#include <algorithm>

namespace segue::runtime::detail {

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

bool LeftActions::concern(const NetworkParts& parts) const {
  const std::lock_guard lock(mutex_);
  return std::ranges::any_of(actions_,
                             [&](const model::Action& action) { return !parts.are_independent_of(action); });
}

}  // namespace segue::runtime::detail

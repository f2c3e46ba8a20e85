// SPDX-License-Identifier: Apache-2.0
#include "overlap_check.hpp"

#include <algorithm>

namespace segue::testing {

void OverlapCheck::note(const mission::StateEvent& event) {
  if (event.is_container) return;
  const std::string name(event.path.substr(event.path.rfind('/') + 1));
  const auto found = mission_.states.find(name);
  if (found == mission_.states.end()) return;
  const Touches& touches = found->second;
  const Lock lock(mutex_);
  if (event.kind == mission::StateEvent::Kind::Began) return begin(name, touches);
  under_way_.erase(name);
  may_be_discarded_.erase(name);
  if (event.outcome != touches.expected) return;
  for (const auto& [fact, holds] : touches.makes)
    holds ? static_cast<void>(facts_.insert(fact)) : static_cast<void>(facts_.erase(fact));
}

void OverlapCheck::begin(const std::string& name, const Touches& touches) {
  if (!touches.is_irreversible) {
    repeated_ += may_be_discarded_.insert(name).second ? 0 : 1;
    return;
  }
  const auto acts_beside = [&](const std::string& other) {
    return !touches.holds.empty() && !mission_.states.at(other).holds.empty();
  };
  overlaps_ += std::ranges::any_of(under_way_, acts_beside) ? 1 : 0;
  for (const std::string& other : under_way_) {
    const std::string why = conflict(touches, mission_.states.at(other));
    if (!problem_ && !why.empty()) problem_ = name + " began while " + other + " was under way: " + why;
  }
  under_way_.insert(name);
}

std::string OverlapCheck::conflict(const Touches& a, const Touches& b) const {
  for (const std::string& resource : a.holds) {
    if (b.holds.contains(resource)) return "both hold " + resource;
  }
  const bool use_both = !a.controller.empty() && !b.controller.empty();
  if (use_both && (a.controller == b.controller || conflicts_.conflict(a.controller, b.controller)))
    return a.controller + " and " + b.controller + " cannot run at once";
  const std::string disturbed = disturbance(a, b);
  return disturbed.empty() ? disturbance(b, a) : disturbed;
}

std::string OverlapCheck::disturbance(const Touches& one, const Touches& other) const {
  for (const auto& [fact, holds] : one.makes) {
    if (facts_.contains(fact) == holds) continue;  // it stays as it is
    if (other.relies_on.contains(fact)) return "one changes " + fact + ", on which the other one relies";
    const auto made = other.makes.find(fact);
    if (made != other.makes.end() && made->second != holds) return "both change " + fact;
  }
  for (const std::string& value : one.changes) {
    if (other.changes.contains(value) || other.sees.contains(value))
      return "one changes " + value + ", which the other one sees or changes";
  }
  return {};
}

std::optional<std::string> OverlapCheck::problem() const {
  const Lock lock(mutex_);
  return problem_;
}

int OverlapCheck::overlaps() const {
  const Lock lock(mutex_);
  return overlaps_;
}

int OverlapCheck::repeated() const {
  const Lock lock(mutex_);
  return repeated_;
}

}  // namespace segue::testing

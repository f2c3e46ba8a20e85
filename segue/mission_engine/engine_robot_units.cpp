// SPDX-License-Identifier: Apache-2.0
//
// Units of observed resources (Resource::observe): nobody gets more of them than the robot shows, and who
// waits for them waits like one whose units others hold, but that no end of an action gives them.
#include <segue/mission_engine/engine_core.hpp>
#include <segue/mission_robot/fact_observer.hpp>

#include <algorithm>
#include <memory>
#include <utility>

namespace segue::mission::detail {

/// There are none until the robot has been looked at. In virtual time, nobody looks at a robot.
void EngineCore::watch_units() {
  if (observer == nullptr || virtual_clock_ != nullptr) return;
  const std::vector<std::string> resources = observer->resources();
  if (resources.empty()) return;
  for (const std::string& resource : resources)
    units.limit(resource, 0);
  const auto take = [this](const ShownUnits& shown) {
    for (const auto& [resource, count] : shown.units)
      units.limit(resource, count);
    robot_units_.are_known = true;
    robot_units_.lost = shown.lost;
  };
  robot_units_.watched =
      observer->watch_units([take, weak = std::weak_ptr(mailbox)](const ShownUnits& shown) {
        if (const auto to = weak.lock()) to->request([take, shown] { take(shown); });
      });
}

/// Says once what the leaf waits for, if the robot keeps it waiting.
void EngineCore::note_unit_wait(Activation& leaf) {
  if (!robot_units_.are_known || !leaf.unit_wait.resource.empty()) return;
  const UnitUse* use = units.limited(leaf.asked);
  if (use == nullptr) return;
  leaf.unit_wait = {use->resource, now(), {}};
  const auto& resources = program->mission().resources;
  const auto resource = std::ranges::find(resources, use->resource, &Resource::name);
  if (options.warn && resource != resources.end() && resource->observe) {
    warn(leaf, unshown_text(use->resource, *resource->observe, use->count, units.limit_of(use->resource)));
  }
}

void EngineCore::end_unit_wait(Activation& leaf) {
  if (leaf.unit_wait.resource.empty()) return;
  leaf.unit_wait.until = now();
  if (leaf.item != History::kNone) history.waited(leaf.item, std::exchange(leaf.unit_wait, {}));
}

/// Whether something may begin as soon as the robot shows more units.
bool EngineCore::awaits_robot() const {
  return robot_units_.watched != nullptr && std::ranges::any_of(asking_, [this](const Waiting& waiting) {
           const Activation& leaf = *waiting.first;
           return leaf.generation == waiting.second && leaf.asks && units.limited(leaf.asked) != nullptr;
         });
}

/// Whether it needs units that no robot will show any more.
bool EngineCore::lacks_lost_robot(const Activation& leaf) const {
  return !robot_units_.lost.empty() && limits_for(leaf) == Units::Limits::Heeded &&
         units.limited(leaf.asked) != nullptr;
}

}  // namespace segue::mission::detail

// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/kept_units.hpp>
#include <segue/mission/unit_keeper.hpp>

#include <cstdint>

namespace segue::mission {

std::vector<std::string> robot_units(const Mission& mission) {
  std::vector<std::string> names;
  for (const Resource& resource : mission.resources) {
    if (resource.of_robot) names.push_back(resource.name);
  }
  return names;
}

UnitChanges changes_of_robot_units(const Mission& mission, const UnitChanges& changes) {
  UnitChanges found;
  for (const std::string& name : robot_units(mission)) {
    const std::string kept = kept_name(name);
    std::int64_t sum = 0;
    for (const auto& [resource, change] : changes) {
      if (resource == name || resource == kept) sum += change;
    }
    if (sum != 0) found.emplace_back(name, sum);
  }
  return found;
}

}  // namespace segue::mission

// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/kept_units.hpp>
#include <segue/mission/units.hpp>

#include <algorithm>
#include <utility>

namespace segue::mission {

namespace {

constexpr std::string_view kKept = " (kept)";

/// The use as a move of units: both happen if the action ends as expected.
void append_move(std::vector<ResourceUse>& uses, const ResourceUse& use, std::string from, std::string to) {
  ResourceUse taken = use;
  taken.keep = false;
  taken.operation = ResourceOperation::Delete;
  taken.resource = std::move(from);
  ResourceUse given = taken;
  given.operation = ResourceOperation::Create;
  given.resource = std::move(to);
  given.parameters = type::Value(type::ValueMap{});
  uses.push_back(std::move(taken));
  uses.push_back(std::move(given));
}

}  // namespace

std::string kept_name(std::string_view resource) {
  return std::string(resource) + std::string(kKept);
}

std::optional<std::string> kept_resource(const ResourceUse& use) {
  if (use.moves_kept_units()) return use.resource;
  if (!is_kept_name(use.resource)) return std::nullopt;
  return use.resource.substr(0, use.resource.size() - kKept.size());
}

bool is_kept_name(std::string_view resource) {
  return resource.ends_with(kKept);
}

void move_kept_units(Mission& mission) {
  std::vector<std::string> patterns;
  for (Action& action : mission.actions) {
    std::vector<ResourceUse> uses;
    for (ResourceUse& use : action.resources) {
      if (const auto kept = kept_resource(use)) patterns.push_back(resource_pattern(*kept));
      if (!use.moves_kept_units()) {
        uses.push_back(std::move(use));
        continue;
      }
      if (use.operation == ResourceOperation::Release)
        append_move(uses, use, kept_name(use.resource), use.resource);
      else
        append_move(uses, use, use.resource, kept_name(use.resource));
    }
    action.resources = std::move(uses);
  }
  const std::size_t declared = mission.resources.size();
  for (std::size_t i = 0; i < declared; ++i) {
    Resource kept = mission.resources[i];
    const auto fits = [&](const std::string& pattern) { return matches_glob(pattern, kept.name); };
    if (std::ranges::none_of(patterns, fits)) continue;
    kept.name = kept_name(kept.name);
    kept.count = 0;
    kept.of_robot = false;  // they are those of the run
    mission.resources.push_back(std::move(kept));
  }
}

}  // namespace segue::mission

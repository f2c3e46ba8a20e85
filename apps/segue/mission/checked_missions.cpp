// SPDX-License-Identifier: Apache-2.0
#include "checked_missions.hpp"

#include <segue/draw/diagram.hpp>
#include <segue/mission/controllers.hpp>
#include <segue/mission/pool_actions.hpp>
#include <segue/mission/program.hpp>
#include <segue/mission_run/loaded_mission.hpp>

#include <utility>

#include "../output.hpp"

namespace segue::cli {

using type::Value;

namespace {

void append(Value::List& all, Value list, const std::string& file) {
  for (Value& pair : list.as_list()) {
    pair.as_map().set("file", file);
    all.push_back(std::move(pair));
  }
}

}  // namespace

void CheckedMissions::check(const std::filesystem::path& file, Diagnostics& diagnostics,
                            const RobotControllers* robot) {
  const auto plan = mission_run::LoadedMission::load(file, {.libraries = libraries_});
  diagnostics.append(plan ? plan->warnings() : diagnostics_of(plan.error()));
  if (!plan) return;
  if (plan->program() != nullptr) scripts_.check(plan->program()->mission(), diagnostics);
  if (robot != nullptr && plan->program() != nullptr) {
    const mission::Mission& mission = plan->program()->mission();
    mission::check_controllers(mission, robot->networks, robot->catalog, diagnostics);
    mission::check_robot_units(mission, robot->units, diagnostics);
    mission::check_pools(mission, robot->pools, robot->catalog, diagnostics);
  }
  auto found = plan->ahead_of_failures();
  if (!found) return diagnostics.error("invalid-mission", found.error().message, {file.string(), 0, 0});
  if (!found->pairs.empty() || !found->senses.empty() || !found->complete)
    entries_.push_back({file.string(), std::move(*found)});
}

void CheckedMissions::print() const {
  for (const Entry& entry : entries_) {
    for (const std::string& text :
         {draw::ahead_text(entry.found.pairs, entry.found.complete), draw::senses_text(entry.found.senses)})
      if (!text.empty()) cli::print(printable(entry.file + ": ") + printable(text));
  }
}

Value CheckedMissions::to_value(const Diagnostics& diagnostics) const {
  Value::List ahead;
  Value::List senses;
  for (const Entry& entry : entries_) {
    append(ahead, draw::ahead_value(entry.found.pairs), entry.file);
    append(senses, draw::senses_value(entry.found.senses), entry.file);
  }
  Value value = cli::to_value(diagnostics);
  value.as_map().set("ahead", std::move(ahead));
  value.as_map().set("senses_ahead", std::move(senses));
  return value;
}

}  // namespace segue::cli

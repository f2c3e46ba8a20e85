// SPDX-License-Identifier: Apache-2.0
#include "checked_missions.hpp"

#include <segue/draw/diagram.hpp>
#include <segue/mission/controllers.hpp>
#include <segue/mission/pools.hpp>
#include <segue/session/session.hpp>

#include <utility>

#include "output.hpp"

namespace segue::cli {

using type::Value;

void CheckedMissions::check(const std::filesystem::path& file, Diagnostics& diagnostics,
                            const RobotControllers* robot) {
  const auto plan = session::Session::load(file, libraries_, diagnostics);
  if (!plan) return;
  if (plan->program() != nullptr) scripts_.check(plan->program()->mission(), diagnostics);
  if (robot != nullptr && plan->program() != nullptr) {
    const mission::Mission& mission = plan->program()->mission();
    mission::check_controllers(mission, robot->networks, robot->catalog, diagnostics);
    mission::check_pools(mission, robot->pools, robot->catalog, diagnostics);
  }
  auto found = plan->ahead_of_failures();
  if (!found) return diagnostics.error("invalid-mission", found.error().message, {file.string(), 0, 0});
  if (!found->pairs.empty() || !found->complete) entries_.push_back({file.string(), std::move(*found)});
}

void CheckedMissions::print() const {
  for (const Entry& entry : entries_)
    cli::print(printable(entry.file + ": ") +
               printable(draw::ahead_text(entry.found.pairs, entry.found.complete)));
}

Value CheckedMissions::to_value(const Diagnostics& diagnostics) const {
  Value::List all;
  for (const Entry& entry : entries_) {
    Value list = draw::ahead_value(entry.found.pairs);
    for (Value& pair : list.as_list()) {
      pair.as_map().set("file", entry.file);
      all.push_back(std::move(pair));
    }
  }
  Value value = cli::to_value(diagnostics);
  value.as_map().set("ahead", std::move(all));
  return value;
}

}  // namespace segue::cli

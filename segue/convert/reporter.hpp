// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/convert/action_environment.hpp>
#include <segue/convert/node_journal.hpp>

#include <atomic>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace segue::convert {

/// Turns the ending of an action into a report for the engine. Immutable but for `cancelled`, which only ever
/// becomes true; the report of a run that was cancelled meanwhile is discarded anyway, so relaxed order would
/// do.
struct ActionEnvironment::Reporter {
  explicit Reporter(mission::Globals used) : globals(std::move(used)) {}

  std::vector<std::string> ports;
  std::vector<task_network::OutcomeId> outcomes;  ///< by the outcomes of the state
  PassedOn passes_on = PassedOn::Nothing;
  std::uint64_t passed_on = 0;  ///< by the execution before
  bool recorded = false;        ///< the run has a journal, or somebody observes units
  mission::Globals globals;     ///< as the action uses them
  std::atomic<bool> cancelled{false};

  [[nodiscard]] task_network::ReportPtr report(const mission::Ending& ending,
                                               std::vector<type::Value> outputs,
                                               const SubtreeChanges& changes = {});
};

}  // namespace segue::convert

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/journal/database.hpp>
#include <segue/journal/entries.hpp>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string_view>

/// Entries from rows of the tables of a journal.
namespace segue::journal::detail {

/// All of an entry but its actions; then 29: lasted, 30 and 31: the ids of the networks before and after.
inline constexpr std::string_view kSelectTransition =
    R"(SELECT id, request, time, cause, who, source, target, runs, "order", outcome, undone, error, solve, total,
       prepare, "commit", retire, total_low, total_typical, total_high, commit_low, commit_typical, commit_high,
       source_version, target_version, runs_version, ready_tasks, unprepared, cancelled_by, lasted, before, after
       FROM "transition")";

std::chrono::system_clock::time_point time_in(const Statement& row, int column);

/// The transition in a row of kSelectTransition, without its networks and actions.
TransitionEntry transition_in(const Statement& row);

/// Adds the actions of the transition of that id; `invalid` counts rows that are none.
Result<void> read_actions(Database& database, std::int64_t transition, TransitionEntry& entry,
                          std::uint64_t& invalid);

/// The entry in a row of kSelectMission;
/// nothing: it is invalid.
inline constexpr std::string_view kSelectMission =
    "SELECT time, kind, who, mission, action, iteration, controller, outcome, error, duration, mode, id FROM "
    "mission";
std::optional<MissionEntry> mission_in(const Statement& row);

}  // namespace segue::journal::detail

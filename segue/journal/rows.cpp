// SPDX-License-Identifier: Apache-2.0
#include <segue/journal/rows.hpp>

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

namespace segue::journal::detail {

std::chrono::system_clock::time_point time_in(const Statement& row, int column) {
  return std::chrono::system_clock::time_point(
      std::chrono::duration_cast<std::chrono::system_clock::duration>(Duration(row.integer(column))));
}

namespace {

Duration duration_in(const Statement& row, int column) {
  return Duration(row.integer(column));
}

/// The enumerator of that name.
template <class Enumeration, class Names>
std::optional<Enumeration> named(const Names& names, const std::string& word) {
  const auto found = std::find(names.begin(), names.end(), word);
  if (found == names.end()) return std::nullopt;
  return static_cast<Enumeration>(found - names.begin());
}

/// Reads low, typical and high starting at a column; nothing unless they are in increasing order.
std::optional<model::DurationRange> range_in(const Statement& row, int first) {
  const model::DurationRange range{duration_in(row, first), duration_in(row, first + 1),
                                   duration_in(row, first + 2)};
  const bool ordered = Duration(0) <= range.low && range.low <= range.typical && range.typical <= range.high;
  if (row.is_null(first) || !ordered) return std::nullopt;
  return range;
}

}  // namespace

TransitionEntry transition_in(const Statement& row) {
  TransitionEntry entry;
  entry.request = static_cast<std::uint64_t>(row.integer(1));
  entry.time = time_in(row, 2);
  entry.cause = row.text(3);
  entry.who = row.text(4);
  entry.from = row.text(5);
  entry.to = row.text(6);
  entry.runs = row.text(7);
  entry.order = row.text(8);
  entry.outcome = row.text(9);
  entry.undone = row.text(10);
  entry.error = row.text(11);
  entry.solve = duration_in(row, 12);
  entry.total = duration_in(row, 13);
  entry.prepare = duration_in(row, 14);
  entry.commit = duration_in(row, 15);
  entry.retire = duration_in(row, 16);
  const auto total = range_in(row, 17);
  const auto commit = range_in(row, 20);
  if (total && commit) entry.predicted = Prediction{*total, *commit};
  entry.from_version = row.text(23);
  entry.to_version = row.text(24);
  entry.runs_version = row.text(25);
  if (row.integer(26) > 0 && row.integer(27) >= 0)
    entry.ahead = PreparedAhead{static_cast<std::size_t>(row.integer(26)), duration_in(row, 27)};
  entry.cancelled_by = row.text(28);
  if (!row.is_null(29)) entry.lasted = duration_in(row, 29);
  return entry;
}

namespace {

std::optional<ActionEntry> action_in(const Statement& row) {
  const auto kind = named<model::ActionKind>(model::kActionKindNames, row.text(1));
  const auto phase = named<model::Phase>(model::kPhaseNames, row.text(2));
  const std::int64_t id = row.integer(0);
  if (!kind || !phase || id < 0 || id > std::numeric_limits<int>::max()) return std::nullopt;
  ActionEntry entry;
  entry.id = static_cast<int>(id);
  entry.kind = *kind;
  entry.phase = *phase;
  entry.label = row.text(3);
  entry.component = row.text(4);
  entry.host = model::HostName(row.text(5));
  entry.process = model::ProcessName(row.text(6));
  entry.started = duration_in(row, 7);
  entry.waited = duration_in(row, 8);
  entry.duration = duration_in(row, 9);
  entry.outcome = row.text(10);
  entry.error = row.text(11);
  if (!row.is_null(12)) entry.ended = duration_in(row, 12);
  return entry;
}

}  // namespace

Result<void> read_actions(Database& database, std::int64_t transition, TransitionEntry& entry,
                          std::uint64_t& invalid) {
  auto rows = database.prepare(
      R"(SELECT id, kind, phase, label, component, host, process, started, waited, duration, outcome, error, ended,
         undoes FROM action WHERE "transition" = ? ORDER BY number)");
  if (!rows) return rows.error();
  rows->start(transition);
  while (true) {
    const auto more = rows->next();
    if (!more) return more.error();
    if (!*more) return {};
    auto action = action_in(*rows);
    if (!action) {
      ++invalid;
    } else {
      (rows->integer(13) == 0 ? entry.actions : entry.undo_actions).push_back(std::move(*action));
    }
  }
}

std::optional<MissionEntry> mission_in(const Statement& row) {
  const auto kind = named<MissionEntry::Kind>(kMissionKindNames, row.text(1));
  if (!kind) return std::nullopt;
  MissionEntry entry;
  entry.time = time_in(row, 0);
  entry.kind = *kind;
  entry.who = row.text(2);
  entry.mission = row.text(3);
  entry.action = row.text(4);
  entry.iteration = static_cast<std::uint64_t>(row.integer(5));
  entry.controller = row.text(6);
  entry.outcome = row.text(7);
  entry.error = row.text(8);
  entry.duration = duration_in(row, 9);
  entry.mode = row.text(10);
  return entry;
}

}  // namespace segue::journal::detail

// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/journal/database.hpp>
#include <segue/journal/reader.hpp>
#include <segue/journal/schema.hpp>
#include <segue/journal/statistics.hpp>

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

namespace segue::journal {

namespace {

using detail::Database;
using detail::Statement;

std::chrono::system_clock::time_point time_in(const Statement& row, int column) {
  return std::chrono::system_clock::time_point(
      std::chrono::duration_cast<std::chrono::system_clock::duration>(Duration(row.integer(column))));
}

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
  return entry;
}

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
  return entry;
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
  return entry;
}

/// Collects the rows of a started statement, which gives the latest first, and returns the oldest first.
template <class Item, class Convert>
Result<std::vector<Item>> collect(Statement& rows, Convert convert) {
  std::vector<Item> items;
  while (true) {
    const auto more = rows.next();
    if (!more) return more.error();
    if (!*more) break;
    items.push_back(convert(rows));
  }
  std::reverse(items.begin(), items.end());
  return items;
}

std::int64_t as_limit(std::size_t limit) {
  return static_cast<std::int64_t>(std::min(limit, std::size_t{1} << 40U));
}

/// The latest rows of a table, oldest first.
template <class Item, class Convert>
Result<std::vector<Item>> latest(Database& database, std::string_view select, std::size_t limit,
                                 Convert convert) {
  auto rows = database.prepare(std::string(select) + " ORDER BY id DESC LIMIT ?");
  if (!rows) return rows.error();
  rows->start(as_limit(limit));
  return collect<Item>(*rows, convert);
}

Error about(const std::filesystem::path& path, Error inner) {
  inner.message = "cannot read the journal " + quote(path.native()) + ": " + inner.message;
  return inner;
}

}  // namespace

struct JournalReader::Implementation {
  std::filesystem::path path;
  Database database;
  std::uint64_t invalid = 0;

  Result<void> read_actions(std::int64_t transition, TransitionEntry& entry) {
    auto rows = database.prepare(
        R"(SELECT id, kind, phase, label, component, host, process, started, waited, duration, outcome, error
           FROM action WHERE "transition" = ? ORDER BY number)");
    if (!rows) return rows.error();
    rows->start(transition);
    while (true) {
      const auto more = rows->next();
      if (!more) return more.error();
      if (!*more) return {};
      auto action = action_in(*rows);
      if (action) {
        entry.actions.push_back(std::move(*action));
      } else {
        ++invalid;
      }
    }
  }

  /// One state of the file for several statements, whatever is written meanwhile.
  template <class Read>
  auto at_one_moment(Read read) -> decltype(read()) {
    if (auto begun = database.execute("BEGIN"); !begun) return about(path, begun.error());
    auto result = read();
    (void)database.execute("COMMIT");
    if (!result) return about(path, result.error());
    return result;
  }
};

JournalReader::JournalReader(std::unique_ptr<Implementation> implementation)
    : implementation_(std::move(implementation)) {}
JournalReader::JournalReader(JournalReader&&) noexcept = default;
JournalReader& JournalReader::operator=(JournalReader&&) noexcept = default;
JournalReader::~JournalReader() = default;

Result<JournalReader> JournalReader::open(const std::filesystem::path& path) {
  std::error_code failed;
  if (!std::filesystem::exists(path, failed)) {
    return fail(ErrorCode::NotFound, "there is no journal " + quote(path.native()));
  }
  auto database = Database::open(path, Database::Mode::Read);
  if (!database) return about(path, database.error());
  if (auto fits = detail::check_schema(*database); !fits) return about(path, fits.error());
  return JournalReader(std::make_unique<Implementation>(Implementation{path, std::move(*database), 0}));
}

Result<std::vector<TransitionEntry>> JournalReader::transitions(std::size_t limit, Actions actions) {
  Implementation& self = *implementation_;
  return self.at_one_moment([&]() -> Result<std::vector<TransitionEntry>> {
    std::vector<std::int64_t> ids;
    auto entries = latest<TransitionEntry>(
        self.database,
        R"(SELECT id, request, time, cause, who, source, target, runs, "order", outcome, undone, error, solve, total,
           prepare, "commit", retire, total_low, total_typical, total_high, commit_low, commit_typical, commit_high,
           source_version, target_version, runs_version, ready_tasks, unprepared, cancelled_by FROM "transition")",
        limit, [&](const Statement& row) {
          ids.push_back(row.integer(0));
          return transition_in(row);
        });
    if (!entries || actions == Actions::Without) return entries;
    for (std::size_t i = 0; i < entries->size(); ++i) {
      if (auto read = self.read_actions(ids[ids.size() - 1 - i], (*entries)[i]); !read) return read.error();
    }
    return entries;
  });
}

Result<std::vector<RequestEntry>> JournalReader::requests(std::size_t limit) {
  Implementation& self = *implementation_;
  return self.at_one_moment([&] {
    return latest<RequestEntry>(self.database, "SELECT request, time, who, what FROM request", limit,
                                [](const Statement& row) {
                                  return RequestEntry{static_cast<std::uint64_t>(row.integer(0)),
                                                      time_in(row, 1), row.text(2), row.text(3)};
                                });
  });
}

Result<std::vector<DifferenceEntry>> JournalReader::differences(std::size_t limit) {
  Implementation& self = *implementation_;
  return self.at_one_moment([&] {
    return latest<DifferenceEntry>(
        self.database, "SELECT time, subject, sentence, done FROM difference", limit,
        [](const Statement& row) {
          return DifferenceEntry{time_in(row, 0), row.text(1), row.text(2), row.text(3)};
        });
  });
}

Result<std::vector<VersionEntry>> JournalReader::versions(std::size_t limit) {
  Implementation& self = *implementation_;
  return self.at_one_moment([&] {
    return latest<VersionEntry>(
        self.database, "SELECT time, controller, version, file, text FROM version", limit,
        [](const Statement& row) {
          return VersionEntry{time_in(row, 0), row.text(1), row.text(2), row.text(3), row.text(4)};
        });
  });
}

Result<std::vector<MissionEntry>> JournalReader::missions(std::size_t limit) {
  Implementation& self = *implementation_;
  return self.at_one_moment([&]() -> Result<std::vector<MissionEntry>> {
    const auto rows =
        latest<std::optional<MissionEntry>>(self.database,
                                            "SELECT time, kind, who, mission, action, iteration, controller, "
                                            "outcome, error, duration FROM mission",
                                            limit, mission_in);
    if (!rows) return rows.error();
    std::vector<MissionEntry> entries;
    for (const auto& row : *rows) {
      if (row) {
        entries.push_back(*row);
      } else {
        ++self.invalid;
      }
    }
    return entries;
  });
}

Result<std::vector<GapEntry>> JournalReader::gaps(std::size_t limit) {
  Implementation& self = *implementation_;
  return self.at_one_moment([&] {
    return latest<GapEntry>(
        self.database, "SELECT time, lost, reason FROM gap", limit, [](const Statement& row) {
          return GapEntry{time_in(row, 0), static_cast<std::uint64_t>(row.integer(1)), row.text(2)};
        });
  });
}

Result<model::ActionTimes> JournalReader::times() {
  auto times = detail::read_times(implementation_->database, implementation_->invalid);
  if (!times) return about(implementation_->path, times.error());
  return times;
}

Result<void> JournalReader::check() {
  const auto found = implementation_->database.text("PRAGMA integrity_check(1)");
  if (!found) return about(implementation_->path, found.error());
  if (*found == "ok") return {};
  return about(implementation_->path, fail(ErrorCode::ParseError, "it is damaged: " + *found));
}

std::uint64_t JournalReader::invalid_rows() const {
  return implementation_->invalid;
}

}  // namespace segue::journal

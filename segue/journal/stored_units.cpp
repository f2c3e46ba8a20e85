// SPDX-License-Identifier: Apache-2.0
#include <segue/journal/stored_units.hpp>

#include <segue/base/text.hpp>
#include <segue/journal/schema.hpp>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace segue::journal {

using detail::Database;

namespace {

/// Changes of executions that are remembered, beside those of the run that was reported last.
constexpr std::string_view kForget = R"(
DELETE FROM change WHERE id <= (SELECT max(id) FROM change) - 100000 AND NOT (robot = ? AND run = ?))";

constexpr std::string_view kUnitTables = R"(
CREATE TABLE unit (robot TEXT NOT NULL, name TEXT NOT NULL, count INTEGER NOT NULL, PRIMARY KEY (robot, name)) WITHOUT ROWID;
CREATE TABLE change (
  id INTEGER PRIMARY KEY, robot TEXT NOT NULL, run TEXT NOT NULL, execution TEXT NOT NULL, name TEXT NOT NULL,
  change INTEGER NOT NULL, UNIQUE (robot, run, execution, name));
)";
constexpr std::array kUnitSteps = {kUnitTables};

Error with_file(Error error, const std::filesystem::path& file) {
  error.message = "the counts of the robot's units in " + quote(file.native()) + ": " + error.message;
  return error;
}

}  // namespace

StoredUnits::StoredUnits(std::filesystem::path file, std::string robot,
                         std::vector<model::UnitStock> declared)
    : file_(std::move(file)), robot_(std::move(robot)), declared_(std::move(declared)) {}

Result<Database*> StoredUnits::open() {
  if (file_.empty())
    return fail(ErrorCode::Unsupported, "the robot keeps no journal, and so no counts of its units either");
  if (!database_) {
    auto opened = detail::open_with_tables(file_, kUnitSteps);
    if (!opened) return with_file(std::move(opened.error()), file_);
    database_ = std::move(*opened);
  }
  return &*database_;
}

Result<std::uint32_t> StoredUnits::count_of(Database& database, std::string_view name) const {
  const auto declared = std::ranges::find(declared_, name, &model::UnitStock::name);
  if (declared == declared_.end()) {
    std::vector<std::string> names;
    for (const model::UnitStock& stock : declared_)
      names.push_back(stock.name);
    return fail(ErrorCode::NotFound,
                "the robot keeps no units " + quote(name) +
                    (names.empty() ? "; its file declares none (`units`)" : did_you_mean(name, names)));
  }
  auto rows = database.prepare("SELECT count FROM unit WHERE robot = ? AND name = ?");
  if (!rows) return rows.error();
  rows->start(std::string_view(robot_), name);
  const auto found = rows->next();
  if (!found) return found.error();
  return *found ? static_cast<std::uint32_t>(rows->integer(0)) : declared->count;
}

Result<void> StoredUnits::write_count(Database& database, std::string_view name, std::int64_t count) const {
  constexpr std::int64_t kMost = std::numeric_limits<std::uint32_t>::max();
  auto row = database.prepare("INSERT OR REPLACE INTO unit (robot, name, count) VALUES (?, ?, ?)");
  if (!row) return row.error();
  return row->run(std::string_view(robot_), name, std::clamp<std::int64_t>(count, 0, kMost));
}

Result<void> StoredUnits::write(const Permit& permit, const std::function<Result<void>(Database&)>& act) {
  const auto database = open();
  if (!database) return database.error();
  if (auto permitted = permit(); !permitted) return permitted;
  if (auto begun = (*database)->execute("BEGIN IMMEDIATE"); !begun)
    return with_file(std::move(begun.error()), file_);
  auto done = act(**database);
  if (done) {
    done = (*database)->execute("COMMIT");
    if (!done) done = with_file(std::move(done.error()), file_);
  }
  if (!done) (*database)->roll_back();
  return done;
}

Result<StoredUnits::Counts> StoredUnits::counts() {
  const Lock lock(mutex_);
  Counts counts;
  if (declared_.empty()) return counts;
  const auto database = open();
  if (!database) return database.error();
  for (const model::UnitStock& stock : declared_) {
    const auto count = count_of(**database, stock.name);
    if (!count) return with_file(count.error(), file_);
    counts.emplace(stock.name, *count);
  }
  return counts;
}

Result<std::uint32_t> StoredUnits::set(std::string_view name, std::uint32_t count, const Permit& permit) {
  const Lock lock(mutex_);
  std::uint32_t before = 0;
  const auto done = write(permit, [&](Database& database) -> Result<void> {
    const auto found = count_of(database, name);
    if (!found) return found.error();
    before = *found;
    return write_count(database, name, count);
  });
  return done ? Result<std::uint32_t>(before) : done.error();
}

Result<void> StoredUnits::check_begin(Database& database, std::string_view run, std::string_view name,
                                      std::uint32_t begun) const {
  const auto now = count_of(database, name);
  if (!now) return now.error();
  auto rows =
      database.prepare("SELECT ifnull(sum(change), 0) FROM change WHERE robot = ? AND run = ? AND name = ?");
  if (!rows) return rows.error();
  rows->start(std::string_view(robot_), run, name);
  if (const auto found = rows->next(); !found) return found.error();
  const std::int64_t own = rows->integer(0);
  const std::int64_t expected = begun + own;
  if (*now == expected) return {};
  return fail(
      ErrorCode::InvalidState,
      "there are " + std::to_string(*now) + " units of the resource " + quote(name) + " now, and would be " +
          std::to_string(expected) +
          " if nobody else had changed that since the run began; start a new run, or say that there are "
          "as many (`segue units set " +
          std::string(name) + " " + std::to_string(expected) + "`)");
}

Result<void> StoredUnits::begin(std::string_view run, const Counts& begun, const Permit& permit) {
  const Lock lock(mutex_);
  const auto database = open();
  if (!database) return database.error();
  if (auto permitted = permit(); !permitted) return permitted;
  for (const auto& [name, count] : begun) {
    if (auto same = check_begin(**database, run, name, count); !same) return same;
  }
  return {};
}

Result<void> StoredUnits::add(Database& database, std::string_view run, const Execution& execution) const {
  for (const auto& [name, change] : execution.changes) {
    const auto count = count_of(database, name);
    if (!count) return count.error();
    auto row = database.prepare(
        "INSERT OR IGNORE INTO change (robot, run, execution, name, change) VALUES (?, ?, ?, ?, ?)");
    if (!row) return row.error();
    auto added = row->run(std::string_view(robot_), run, std::string_view(execution.name), name, change);
    if (!added) return added;
    const auto is_new = database.integer("SELECT changes()");
    if (!is_new) return is_new.error();
    if (*is_new == 0) continue;
    if (auto written = write_count(database, name, std::int64_t{*count} + change); !written) return written;
  }
  return {};
}

Result<void> StoredUnits::change(std::string_view run, const std::vector<Execution>& executions,
                                 const Permit& permit) {
  const Lock lock(mutex_);
  return write(permit, [&](Database& database) -> Result<void> {
    for (const Execution& execution : executions) {
      if (auto added = add(database, run, execution); !added) return added;
    }
    auto forget = database.prepare(kForget);
    if (!forget) return forget.error();
    return forget->run(std::string_view(robot_), run);
  });
}

}  // namespace segue::journal

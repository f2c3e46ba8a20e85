// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/journal/database.hpp>
#include <segue/journal/journal_reader.hpp>
#include <segue/journal/rows.hpp>
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
using detail::mission_in;
using detail::Statement;
using detail::time_in;
using detail::transition_in;

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

/// The innermost of the folders around the file; else the first.
const std::string& nearest(const std::vector<std::string>& folders, const std::filesystem::path& file) {
  std::error_code failed;
  auto around = std::filesystem::weakly_canonical(std::filesystem::absolute(file, failed), failed);
  while (around.has_relative_path()) {
    const auto found = std::ranges::find(folders, around.native());
    if (found != folders.end()) return *found;
    around = around.parent_path();
  }
  return folders.front();
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
    auto entries =
        latest<TransitionEntry>(self.database, detail::kSelectTransition, limit, [&](const Statement& row) {
          ids.push_back(row.integer(0));
          return transition_in(row);
        });
    if (!entries || actions == Actions::Without) return entries;
    for (std::size_t i = 0; i < entries->size(); ++i) {
      auto read = detail::read_actions(self.database, ids[ids.size() - 1 - i], (*entries)[i], self.invalid);
      if (!read) return read.error();
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
        latest<std::optional<MissionEntry>>(self.database, detail::kSelectMission, limit, mission_in);
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
  return times_near({});
}

Result<model::ActionTimes> JournalReader::times_near(const std::filesystem::path& file) {
  Database& database = implementation_->database;
  return implementation_->at_one_moment([&]() -> Result<model::ActionTimes> {
    const auto folders = detail::folders_with_times(database);
    if (!folders) return folders.error();
    if (folders->empty()) return model::ActionTimes{};
    return detail::read_times(database, nearest(*folders, file), implementation_->invalid);
  });
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

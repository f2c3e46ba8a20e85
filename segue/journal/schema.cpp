// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/journal/schema.hpp>

#include <array>
#include <string>
#include <system_error>

namespace segue::journal::detail {

namespace {

constexpr std::int64_t kApplication = 0x53454755;  // "SEGU"

/// Times are nanoseconds: `time` since 1970, all others as durations. Enumerations are words.
constexpr std::string_view kFirst = R"(
CREATE TABLE "transition" (
  id INTEGER PRIMARY KEY, request INTEGER NOT NULL, time INTEGER NOT NULL, cause TEXT NOT NULL,
  who TEXT NOT NULL, source TEXT NOT NULL, target TEXT NOT NULL, runs TEXT NOT NULL, "order" TEXT NOT NULL,
  outcome TEXT NOT NULL, undone TEXT NOT NULL, error TEXT NOT NULL, solve INTEGER NOT NULL,
  total INTEGER NOT NULL, prepare INTEGER NOT NULL, "commit" INTEGER NOT NULL, retire INTEGER NOT NULL,
  total_low INTEGER, total_typical INTEGER, total_high INTEGER,
  commit_low INTEGER, commit_typical INTEGER, commit_high INTEGER, actions INTEGER NOT NULL);
CREATE TABLE action (
  "transition" INTEGER NOT NULL REFERENCES "transition"(id), number INTEGER NOT NULL, id INTEGER NOT NULL,
  kind TEXT NOT NULL, phase TEXT NOT NULL, label TEXT NOT NULL, component TEXT NOT NULL, host TEXT NOT NULL,
  process TEXT NOT NULL, started INTEGER NOT NULL, waited INTEGER NOT NULL, duration INTEGER NOT NULL,
  outcome TEXT NOT NULL, error TEXT NOT NULL, PRIMARY KEY ("transition", number)) WITHOUT ROWID;
CREATE TABLE request (
  id INTEGER PRIMARY KEY, request INTEGER NOT NULL, time INTEGER NOT NULL, who TEXT NOT NULL, what TEXT NOT NULL);
CREATE TABLE difference (
  id INTEGER PRIMARY KEY, time INTEGER NOT NULL, subject TEXT NOT NULL, sentence TEXT NOT NULL, done TEXT NOT NULL);
CREATE TABLE gap (id INTEGER PRIMARY KEY, time INTEGER NOT NULL, lost INTEGER NOT NULL, reason TEXT NOT NULL);
CREATE TABLE duration (
  component TEXT NOT NULL, kind TEXT NOT NULL, host TEXT NOT NULL, count INTEGER NOT NULL, mean INTEGER NOT NULL,
  recent TEXT NOT NULL, time INTEGER NOT NULL, PRIMARY KEY (component, kind, host)) WITHOUT ROWID;
)";

constexpr std::string_view kVersions = R"(
ALTER TABLE "transition" ADD COLUMN source_version TEXT NOT NULL DEFAULT '';
ALTER TABLE "transition" ADD COLUMN target_version TEXT NOT NULL DEFAULT '';
ALTER TABLE "transition" ADD COLUMN runs_version TEXT NOT NULL DEFAULT '';
CREATE TABLE version (
  id INTEGER PRIMARY KEY, time INTEGER NOT NULL, controller TEXT NOT NULL, version TEXT NOT NULL, file TEXT NOT NULL,
  text TEXT NOT NULL, UNIQUE (controller, version));
)";

constexpr std::string_view kMissions = R"(
CREATE TABLE mission (
  id INTEGER PRIMARY KEY, time INTEGER NOT NULL, kind TEXT NOT NULL, who TEXT NOT NULL, mission TEXT NOT NULL,
  action TEXT NOT NULL, iteration INTEGER NOT NULL, controller TEXT NOT NULL, outcome TEXT NOT NULL,
  error TEXT NOT NULL, duration INTEGER NOT NULL);
)";

constexpr std::string_view kPreparedAhead = R"(
ALTER TABLE "transition" ADD COLUMN ready_tasks INTEGER;
ALTER TABLE "transition" ADD COLUMN unprepared INTEGER;
)";

constexpr std::string_view kCancelled = R"(
ALTER TABLE "transition" ADD COLUMN cancelled_by TEXT NOT NULL DEFAULT '';
)";

/// `before`, `after` and `network` are ids of networks; NULL: not recorded.
constexpr std::string_view kPast = R"(
ALTER TABLE "transition" ADD COLUMN lasted INTEGER;
ALTER TABLE "transition" ADD COLUMN before INTEGER;
ALTER TABLE "transition" ADD COLUMN after INTEGER;
ALTER TABLE action ADD COLUMN ended INTEGER;
ALTER TABLE action ADD COLUMN undoes INTEGER NOT NULL DEFAULT 0;
CREATE TABLE network (id INTEGER PRIMARY KEY, digest TEXT NOT NULL UNIQUE, text TEXT NOT NULL);
CREATE TABLE running (
  id INTEGER PRIMARY KEY, time INTEGER NOT NULL, kind TEXT NOT NULL, controller TEXT NOT NULL, network INTEGER);
CREATE INDEX transition_time ON "transition" (time);
)";

/// Durations are those of a robot's folder: robots of one name in two folders have little in common. Older
/// ones, of which only the name is known, count where there is no folder.
constexpr std::string_view kFolders = R"(
ALTER TABLE duration RENAME TO duration_by_name;
CREATE TABLE duration (
  folder TEXT NOT NULL, component TEXT NOT NULL, kind TEXT NOT NULL, host TEXT NOT NULL, count INTEGER NOT NULL,
  mean INTEGER NOT NULL, recent TEXT NOT NULL, time INTEGER NOT NULL,
  PRIMARY KEY (folder, component, kind, host)) WITHOUT ROWID;
INSERT INTO duration SELECT '', component, kind, host, count, mean, recent, time FROM duration_by_name;
DROP TABLE duration_by_name;
)";

constexpr std::string_view kModes = R"(
ALTER TABLE mission ADD COLUMN mode TEXT NOT NULL DEFAULT '';
CREATE INDEX mission_run ON mission (id) WHERE action = '';
)";

constexpr std::array kSteps = {kFirst,     kVersions, kMissions, kPreparedAhead,
                               kCancelled, kPast,     kFolders,  kModes};

/// The write-ahead log is truncated to this limit after a checkpoint.
constexpr std::string_view kSetUp = R"(
PRAGMA journal_mode = WAL;
PRAGMA synchronous = FULL;
PRAGMA journal_size_limit = 4194304;
PRAGMA trusted_schema = OFF;
)";

Result<void> create_folder(const std::filesystem::path& path) {
  std::error_code failed;
  std::filesystem::create_directories(path.parent_path(), failed);
  if (!failed) return {};
  return fail(ErrorCode::PermissionDenied,
              "cannot create the folder " + quote(path.parent_path().native()) + ": " + failed.message());
}

Error not_ours() {
  return fail(ErrorCode::InvalidArgument, "it is a database of another program, not a journal of Segue");
}

Error newer(std::int64_t version, std::size_t known) {
  return fail(ErrorCode::Unsupported, "a newer Segue wrote it (version " + std::to_string(version) +
                                          " of the journal, this one knows " + std::to_string(known) +
                                          "); update Segue, or move the file away");
}

/// The version of the file; 0 if it is empty.
Result<std::int64_t> version_of(Database& database, std::size_t known) {
  const auto application = database.integer("PRAGMA application_id");
  if (!application) return application.error();
  auto version = database.integer("PRAGMA user_version");
  if (!version) return version.error();
  const auto tables = database.integer("SELECT count(*) FROM sqlite_schema");
  if (!tables) return tables.error();
  if (*application == 0 && *version == 0 && *tables == 0) return 0;
  if (*application != kApplication || *version < 1) return not_ours();
  if (*version > static_cast<std::int64_t>(known)) return newer(*version, known);
  return version;
}

Result<void> take_steps(Database& database, std::size_t first, std::span<const std::string_view> steps) {
  for (std::size_t i = first; i < steps.size(); ++i) {
    if (auto done = database.execute(std::string(steps[i])); !done) return done;
  }
  return database.execute("PRAGMA application_id = " + std::to_string(kApplication) +
                          "; PRAGMA user_version = " + std::to_string(steps.size()) + "; COMMIT");
}

}  // namespace

std::span<const std::string_view> schema_steps() {
  return kSteps;
}

Result<void> bring_up_to_date(Database& database, std::span<const std::string_view> steps) {
  auto found = version_of(database, steps.size());
  if (!found) return found.error();
  if (*found == static_cast<std::int64_t>(steps.size())) return {};
  // The write lock keeps other processes that open the file now from taking the same steps.
  if (auto begun = database.execute("BEGIN IMMEDIATE"); !begun) return begun;
  found = version_of(database, steps.size());
  auto done = found ? take_steps(database, static_cast<std::size_t>(*found), steps)
                    : Result<void>(std::move(found.error()));
  database.roll_back();
  return done;
}

Result<Database> open_with_tables(const std::filesystem::path& path,
                                  std::span<const std::string_view> steps) {
  if (auto created = create_folder(path); !created) return created.error();
  auto database = Database::open(path, Database::Mode::Write);
  if (!database) return database;
  if (auto done = bring_up_to_date(*database, steps); !done) return done.error();
  if (auto done = database->execute(std::string(kSetUp)); !done) return done.error();
  return database;
}

Result<void> check_schema(Database& database) {
  const std::size_t known = schema_steps().size();
  const auto version = version_of(database, known);
  if (!version) return version.error();
  if (*version == 0) return fail(ErrorCode::NotFound, "nothing was written to it yet");
  if (*version == static_cast<std::int64_t>(known)) return {};
  return fail(ErrorCode::Unsupported,
              "an older Segue wrote it; run the robot once, which brings it up to date");
}

}  // namespace segue::journal::detail

// SPDX-License-Identifier: Apache-2.0
#include <segue/base/sha256.hpp>
#include <segue/base/text.hpp>
#include <segue/journal/schema.hpp>
#include <segue/journal/statistics.hpp>
#include <segue/journal/store.hpp>

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <string>
#include <system_error>

namespace segue::journal::detail {

namespace {

/// Longer texts are cut.
constexpr std::size_t kLongestText = 4096;
/// Longer networks are not kept.
constexpr std::size_t kLongestNetwork = std::size_t{1} << 20;

std::string_view cut(std::string_view text) {
  return text.substr(0, kLongestText);
}

std::int64_t since_1970(std::chrono::system_clock::time_point time) {
  return std::chrono::duration_cast<Duration>(time.time_since_epoch()).count();
}

Result<void> check_pages(Database& database) {
  const auto found = database.text("PRAGMA quick_check(1)");
  if (!found) return found.error();
  if (*found == "ok") return {};
  return fail(ErrorCode::ParseError, "it is damaged: " + *found);
}

Result<void> write_row(Database& database, const RequestEntry& entry) {
  auto row = database.prepare("INSERT INTO request (request, time, who, what) VALUES (?, ?, ?, ?)");
  if (!row) return row.error();
  return row->run(static_cast<std::int64_t>(entry.request), since_1970(entry.time), cut(entry.who),
                  cut(entry.what));
}

Result<void> write_row(Database& database, const DifferenceEntry& entry) {
  auto row = database.prepare("INSERT INTO difference (time, subject, sentence, done) VALUES (?, ?, ?, ?)");
  if (!row) return row.error();
  return row->run(since_1970(entry.time), cut(entry.subject), cut(entry.sentence), cut(entry.done));
}

Result<void> write_row(Database& database, const VersionEntry& entry) {
  auto row = database.prepare(
      "INSERT OR IGNORE INTO version (time, controller, version, file, text) VALUES (?, ?, ?, ?, ?)");
  if (!row) return row.error();
  const bool is_short = entry.text.size() <= kLongestNetwork;
  return row->run(since_1970(entry.time), cut(entry.controller), cut(entry.version), cut(entry.file),
                  is_short ? std::string_view(entry.text) : std::string_view(""));
}

Result<void> write_row(Database& database, const MissionEntry& entry) {
  auto row = database.prepare(
      "INSERT INTO mission (time, kind, who, mission, action, iteration, controller, outcome, error, "
      "duration, mode) "
      "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  if (!row) return row.error();
  return row->run(since_1970(entry.time), to_string(entry.kind), cut(entry.who), cut(entry.mission),
                  cut(entry.action), static_cast<std::int64_t>(entry.iteration), cut(entry.controller),
                  cut(entry.outcome), cut(entry.error), entry.duration.count(), cut(entry.mode));
}

Result<void> write_row(Database& database, const GapEntry& entry) {
  auto row = database.prepare("INSERT INTO gap (time, lost, reason) VALUES (?, ?, ?)");
  if (!row) return row.error();
  return row->run(since_1970(entry.time), static_cast<std::int64_t>(entry.lost), cut(entry.reason));
}

/// The id of the network, which is kept once; nothing: there is none, or it is too long to be kept.
Result<std::optional<std::int64_t>> keep_network(Database& database, const std::string& text) {
  if (text.empty() || text.size() > kLongestNetwork) return std::optional<std::int64_t>();
  const std::string digest = sha256(text);
  auto row = database.prepare("INSERT OR IGNORE INTO network (digest, text) VALUES (?, ?)");
  if (!row) return row.error();
  if (auto done = row->run(digest, text); !done) return done.error();
  auto found = database.prepare("SELECT id FROM network WHERE digest = ?");
  if (!found) return found.error();
  found->start(digest);
  const auto some = found->next();
  if (!some) return some.error();
  return *some ? std::optional<std::int64_t>(found->integer(0)) : std::nullopt;
}

Result<void> write_row(Database& database, const RunningEntry& entry) {
  const auto network = keep_network(database, entry.network);
  if (!network) return network.error();
  auto row = database.prepare("INSERT INTO running (time, kind, controller, network) VALUES (?, ?, ?, ?)");
  if (!row) return row.error();
  const std::string_view kind = entry.kind == RunningEntry::Kind::Began ? "began" : "ended";
  return row->run(since_1970(entry.time), kind, cut(entry.controller), *network);
}

Result<void> write_head(Database& database, const TransitionEntry& entry) {
  const auto before = keep_network(database, entry.before);
  if (!before) return before.error();
  const auto after = keep_network(database, entry.after);
  if (!after) return after.error();
  auto row = database.prepare(
      R"(INSERT INTO "transition" (request, time, cause, who, source, target, runs, "order", outcome, undone, error,
         solve, total, prepare, "commit", retire, total_low, total_typical, total_high, commit_low, commit_typical,
         commit_high, actions, source_version, target_version, runs_version, ready_tasks, unprepared, cancelled_by,
         lasted, before, after) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?))");
  if (!row) return row.error();
  using Optional = std::optional<std::int64_t>;
  const auto predicted = [&](model::DurationRange Prediction::*range, Duration model::DurationRange::*part) {
    return entry.predicted ? Optional(((*entry.predicted).*range.*part).count()) : Optional();
  };
  using model::DurationRange;
  return row->run(
      static_cast<std::int64_t>(entry.request), since_1970(entry.time), cut(entry.cause), cut(entry.who),
      cut(entry.from), cut(entry.to), cut(entry.runs), cut(entry.order), cut(entry.outcome),
      cut(entry.undone), cut(entry.error), entry.solve.count(), entry.total.count(), entry.prepare.count(),
      entry.commit.count(), entry.retire.count(), predicted(&Prediction::total, &DurationRange::low),
      predicted(&Prediction::total, &DurationRange::typical),
      predicted(&Prediction::total, &DurationRange::high),
      predicted(&Prediction::commit, &DurationRange::low),
      predicted(&Prediction::commit, &DurationRange::typical),
      predicted(&Prediction::commit, &DurationRange::high),
      static_cast<std::int64_t>(entry.actions.size() + entry.undo_actions.size()), cut(entry.from_version),
      cut(entry.to_version), cut(entry.runs_version),
      entry.ahead ? Optional(static_cast<std::int64_t>(entry.ahead->tasks)) : Optional(),
      entry.ahead ? Optional(entry.ahead->unprepared.count()) : Optional(), cut(entry.cancelled_by),
      entry.lasted ? Optional(entry.lasted->count()) : Optional(), *before, *after);
}

Result<void> write_actions(Database& database, const TransitionEntry& entry) {
  const auto number = database.integer("SELECT last_insert_rowid()");
  if (!number) return number.error();
  auto row = database.prepare(
      R"(INSERT INTO action ("transition", number, id, kind, phase, label, component, host, process, started, waited,
         duration, outcome, error, ended, undoes) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?))");
  if (!row) return row.error();
  using Optional = std::optional<std::int64_t>;
  const std::size_t forward = entry.actions.size();
  for (std::size_t i = 0; i < forward + entry.undo_actions.size(); ++i) {
    const ActionEntry& action = i < forward ? entry.actions[i] : entry.undo_actions[i - forward];
    const auto ended = Optional(action.ended.value_or(Duration(-1)).count());
    auto done =
        row->run(*number, static_cast<std::int64_t>(i), static_cast<std::int64_t>(action.id),
                 to_string(action.kind), to_string(action.phase), cut(action.label), cut(action.component),
                 cut(action.host.str()), cut(action.process.str()), action.started.count(),
                 action.waited.count(), action.duration.count(), cut(action.outcome), cut(action.error),
                 action.ended ? ended : Optional(), static_cast<std::int64_t>(i < forward ? 0 : 1));
    if (!done) return done;
  }
  return {};
}

Result<void> write_row(Database& database, const TransitionEntry& entry) {
  if (auto done = write_head(database, entry); !done) return done;
  return write_actions(database, entry);
}

}  // namespace

Store::Store(Database database, std::filesystem::path path, const JournalOptions& options)
    : database_(std::move(database)),
      path_(std::move(path)),
      identity_(identify(path_)),
      keep_actions_(options.keep_actions),
      folder_(options.robot_folder.native()) {}

Store::Identity Store::identify(const std::filesystem::path& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return {};
  return {status.st_dev, status.st_ino};
}

bool Store::is_in_place() const {
  return identify(path_) == identity_;
}

Result<Store> Store::open(const std::filesystem::path& path, const JournalOptions& options) {
  auto database = open_with_tables(path);
  if (!database) return database.error();
  Store store(std::move(*database), path, options);
  if (auto sound = check_pages(store.database_); !sound) return sound.error();
  if (auto done = remove_old_statistics(store.database_); !done) return done.error();
  std::uint64_t invalid = 0;
  auto times = read_times(store.database_, store.folder_, invalid);
  if (!times) return times.error();
  store.times_ = std::move(*times);
  const auto kept = store.database_.integer(R"(SELECT count(*) + total(actions) FROM "transition")");
  if (!kept) return kept.error();
  store.kept_ = static_cast<std::size_t>(std::max<std::int64_t>(*kept, 0));
  return store;
}

Result<void> Store::write(std::span<const AnyEntry> entries) {
  if (auto begun = database_.execute("BEGIN IMMEDIATE"); !begun) return begun;
  model::ActionTimes times = times_;
  std::size_t added = 0;
  for (const AnyEntry& entry : entries)
    added += std::holds_alternative<TransitionEntry>(entry) ? weight_of(entry) : 0;
  auto done = insert(entries, times);
  if (done) done = remove_old(added);
  if (done) done = database_.execute("COMMIT");
  if (!done) {
    database_.roll_back();
    return done;
  }
  times_ = std::move(times);
  return {};
}

Result<void> Store::insert(std::span<const AnyEntry> entries, model::ActionTimes& times) {
  for (const AnyEntry& entry : entries) {
    auto done = std::visit([this](const auto& one) { return write_row(database_, one); }, entry);
    const auto* transition = std::get_if<TransitionEntry>(&entry);
    if (done && transition != nullptr) done = learn(*transition, times);
    if (!done) return done;
  }
  return {};
}

Result<void> Store::learn(const TransitionEntry& entry, model::ActionTimes& times) {
  return add_samples(database_, folder_, duration_samples(entry), since_1970(entry.time), times);
}

Result<void> Store::remove_old(std::size_t added) {
  kept_ += added;
  const auto few = static_cast<std::int64_t>(std::max<std::size_t>(keep_actions_ / 10, 1));
  for (const std::string table : {"request", "difference", "version", "mission", "running", "gap"}) {
    std::string statement = "DELETE FROM ";
    statement.append(table).append(" WHERE id <= (SELECT max(id) FROM ").append(table).append(") - ?");
    auto row = database_.prepare(statement);
    if (!row) return row.error();
    if (auto done = row->run(few); !done) return done;
  }
  return kept_ > keep_actions_ ? remove_old_transitions() : Result<void>();
}

/// Removes down to nine tenths of the limit, so that it is not needed for every write. Keeps the latest
/// transition, whatever its size.
Result<void> Store::remove_old_transitions() {
  auto rows = database_.prepare(R"(SELECT id, actions + 1 FROM "transition" ORDER BY id DESC)");
  if (!rows) return rows.error();
  rows->start();
  std::size_t kept = 0;
  std::int64_t last_removed = 0;
  while (true) {
    const auto more = rows->next();
    if (!more) return more.error();
    if (!*more) break;
    const auto size = static_cast<std::size_t>(std::max<std::int64_t>(rows->integer(1), 1));
    if (kept > 0 && kept + size > keep_actions_ / 10 * 9) {
      last_removed = rows->integer(0);
      break;
    }
    kept += size;
  }
  rows->start();  // ends the read, so that rows can be deleted
  kept_ = kept;
  for (const std::string_view removal :
       {R"(DELETE FROM action WHERE "transition" <= ?)", R"(DELETE FROM "transition" WHERE id <= ?)"}) {
    auto row = database_.prepare(removal);
    if (!row) return row.error();
    if (auto done = row->run(last_removed); !done) return done;
  }
  return database_.execute(
      R"(DELETE FROM network WHERE id NOT IN (SELECT before FROM "transition" WHERE before IS NOT NULL
         UNION SELECT after FROM "transition" WHERE after IS NOT NULL
         UNION SELECT network FROM running WHERE network IS NOT NULL))");
}

}  // namespace segue::journal::detail

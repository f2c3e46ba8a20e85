// SPDX-License-Identifier: Apache-2.0
#include <segue/journal/statistics.hpp>

#include <algorithm>
#include <charconv>
#include <map>
#include <optional>
#include <string>

namespace segue::journal {

DurationSamples duration_samples(const TransitionEntry& entry) {
  DurationSamples samples;
  for (const ActionEntry& action : entry.actions) {
    if (action.outcome != kDone || action.duration < Duration(0)) {
      continue;
    }
    samples.actions.push_back({{action.component, action.kind, action.host}, action.duration});
    samples.waits.push_back(std::max(action.waited, Duration(0)));
  }
  return samples;
}

namespace detail {

namespace {

constexpr std::int64_t kMostRows = 20'000;
/// The `kind` of the row that holds waits; no kind of action has this name.
constexpr std::string_view kWait = "wait";

std::optional<model::ActionKind> kind_of(std::string_view word) {
  const auto found = std::find(model::kActionKindNames.begin(), model::kActionKindNames.end(), word);
  if (found == model::kActionKindNames.end()) return std::nullopt;
  return static_cast<model::ActionKind>(found - model::kActionKindNames.begin());
}

std::string written(const std::vector<Duration>& durations) {
  std::string text;
  for (const Duration duration : durations)
    text += (text.empty() ? "" : " ") + std::to_string(duration.count());
  return text;
}

/// Parses non-negative numbers separated by single spaces, at most as many as a record holds.
std::optional<std::vector<Duration>> parsed(std::string_view text) {
  std::vector<Duration> durations;
  const char* place = text.data();
  const char* const end = place + text.size();
  while (place != end) {
    std::int64_t count = 0;
    const auto [rest, error] = std::from_chars(place, end, count);
    const bool ends_well = rest == end || (*rest == ' ' && rest + 1 != end);
    if (error != std::errc() || count < 0 || !ends_well) return std::nullopt;
    durations.emplace_back(count);
    if (durations.size() > model::DurationRecord::kRecent) return std::nullopt;
    place = rest == end ? end : rest + 1;
  }
  return durations;
}

/// Reads the columns count, mean and recent, starting at `first`.
std::optional<model::DurationRecord> record_in(const Statement& row, int first) {
  auto recent = parsed(row.text(first + 2));
  const std::int64_t count = row.integer(first);
  const std::int64_t mean = row.integer(first + 1);
  if (!recent || recent->empty() || mean < 0 || count < static_cast<std::int64_t>(recent->size())) {
    return std::nullopt;
  }
  return model::DurationRecord{static_cast<std::uint64_t>(count), Duration(mean), std::move(*recent)};
}

/// The rows of the table `duration` by key.
class Rows {
 public:
  static Result<Rows> prepare(Database& database, const std::string& folder) {
    auto select = database.prepare(
        "SELECT count, mean, recent FROM duration WHERE folder = ? AND component = ? AND kind = ? AND host = "
        "?");
    if (!select) return select.error();
    auto replace = database.prepare(
        "INSERT OR REPLACE INTO duration (folder, component, kind, host, count, mean, recent, time) "
        "VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
    if (!replace) return replace.error();
    return Rows(folder, std::move(*select), std::move(*replace));
  }

  Result<void> add(std::string_view component, std::string_view kind, std::string_view host,
                   const std::vector<Duration>& durations, std::int64_t time, model::DurationRecord& record) {
    select_.start(folder_, component, kind, host);
    const auto known = select_.next();
    if (!known) return known.error();
    record = {};
    if (*known) record = record_in(select_, 0).value_or(model::DurationRecord{});
    for (const Duration duration : durations)
      record.add(duration);
    return replace_.run(folder_, component, kind, host, static_cast<std::int64_t>(record.count),
                        record.mean.count(), written(record.recent), time);
  }

 private:
  Rows(std::string folder, Statement select, Statement replace)
      : folder_(std::move(folder)), select_(std::move(select)), replace_(std::move(replace)) {}
  std::string folder_;
  Statement select_;
  Statement replace_;
};

}  // namespace

Result<model::ActionTimes> read_times(Database& database, const std::string& folder, std::uint64_t& invalid) {
  auto rows =
      database.prepare("SELECT component, kind, host, count, mean, recent FROM duration WHERE folder = ?");
  if (!rows) return rows.error();
  rows->start(folder);
  model::ActionTimes times;
  while (true) {
    const auto more = rows->next();
    if (!more) return more.error();
    if (!*more) return times;
    const std::string word = rows->text(1);
    const auto kind = kind_of(word);
    auto record = record_in(*rows, 3);
    if (record && kind) {
      times.actions[{rows->text(0), *kind, model::HostName(rows->text(2))}] = std::move(*record);
    } else if (record && word == kWait) {
      times.waits = std::move(*record);
    } else {
      ++invalid;
    }
  }
}

Result<std::vector<std::string>> folders_with_times(Database& database) {
  auto rows = database.prepare("SELECT folder FROM duration GROUP BY folder ORDER BY max(time) DESC");
  if (!rows) return rows.error();
  std::vector<std::string> folders;
  while (true) {
    const auto more = rows->next();
    if (!more) return more.error();
    if (!*more) return folders;
    folders.push_back(rows->text(0));
  }
}

Result<void> add_samples(Database& database, const std::string& folder, const DurationSamples& samples,
                         std::int64_t time, model::ActionTimes& times) {
  auto rows = Rows::prepare(database, folder);
  if (!rows) return rows.error();
  std::map<model::ActionKey, std::vector<Duration>> grouped;
  for (const auto& [key, duration] : samples.actions)
    grouped[key].push_back(duration);
  for (const auto& [key, durations] : grouped) {
    auto done =
        rows->add(key.component, to_string(key.kind), key.host.str(), durations, time, times.actions[key]);
    if (!done) return done;
  }
  if (samples.waits.empty()) return {};
  return rows->add("", kWait, "", samples.waits, time, times.waits);
}

Result<void> remove_old_statistics(Database& database) {
  const auto rows = database.integer("SELECT count(*) FROM duration");
  if (!rows) return rows.error();
  if (*rows <= kMostRows) return {};
  auto removal = database.prepare(
      "DELETE FROM duration WHERE time <= (SELECT time FROM duration ORDER BY time DESC LIMIT 1 OFFSET ?)");
  if (!removal) return removal.error();
  return removal->run(kMostRows * 9 / 10);
}

}  // namespace detail

}  // namespace segue::journal

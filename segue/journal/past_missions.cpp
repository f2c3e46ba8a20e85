// SPDX-License-Identifier: Apache-2.0
#include <segue/journal/past_missions.hpp>

#include <segue/journal/journal_report.hpp>
#include <segue/journal/past_question.hpp>
#include <segue/journal/rows.hpp>

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>

namespace segue::journal::detail {

using type::Value;

namespace {

constexpr std::int64_t kMostRunEntries = 4000;

/// A run of a mission: its begin, and its end if that is recorded.
Value run_value(const Statement& began, const Value& ended_s, const std::string& outcome,
                const std::string& error) {
  return Value::map({{"id", began.integer(0)},
                     {"mission", began.text(4)},
                     {"who", began.text(3)},
                     {"mode", began.text(5)},
                     {"began_s", seconds(began.integer(1))},
                     {"ended_s", ended_s},
                     {"outcome", outcome},
                     {"error", error}});
}

/// The begins and ends of missions, which do not overlap, since one at a time commands a robot.
constexpr const char* kSelectRuns =
    "SELECT id, time, kind, who, mission, mode, outcome, error FROM mission WHERE action = '' AND ";

Value mission_entry_in(const Statement& row) {
  const auto entry = mission_in(row);
  if (!entry) return {};
  Value value = to_value(*entry);
  type::ValueMap& map = value.as_map();
  map.set("number", row.integer(11));
  map.set("time_s", seconds(row.integer(0)));
  map.set("action", entry->action);
  map.set("iteration", entry->iteration);
  return value;
}

/// The entries of the mission from row `first` to row `last`, oldest first.
Result<Value::List> mission_entries(Database& database, std::int64_t first, std::int64_t last) {
  auto rows =
      database.prepare(std::string(kSelectMission) + " WHERE id >= ? AND id <= ? ORDER BY id DESC LIMIT ?");
  if (!rows) return rows.error();
  rows->start(first, last, kMostRunEntries);
  auto entries = list_of(*rows, mission_entry_in);
  if (!entries) return entries.error();
  std::erase_if(*entries, [](const Value& entry) { return entry.is_null(); });
  std::reverse(entries->begin(), entries->end());
  return entries;
}

}  // namespace

Result<Value> missions(Database& database, const Value& question) {
  const auto page = page_asked(question);
  if (!page) return page.error();
  auto rows = database.prepare(std::string(kSelectRuns) + "id < ? ORDER BY id DESC");
  if (!rows) return rows.error();
  rows->start(page->before);
  Value::List runs;
  Value ended_s;
  std::string outcome;
  std::string error;
  while (runs.size() <= static_cast<std::size_t>(page->limit)) {
    const auto more = rows->next();
    if (!more) return more.error();
    if (!*more) break;
    const bool began = rows->text(2) == "began";
    if (began) runs.push_back(run_value(*rows, ended_s, outcome, error));
    ended_s = began ? Value() : Value(seconds(rows->integer(1)));
    outcome = began ? "" : rows->text(6);
    error = began ? "" : rows->text(7);
  }
  const bool more = runs.size() > static_cast<std::size_t>(page->limit);
  if (more) runs.pop_back();
  return Value::map({{"missions", std::move(runs)}, {"more", more}});
}

Result<Value> mission(Database& database, const Value& question) {
  const auto id = whole(question, "id", 0);
  if (!id) return id.error();
  auto rows = database.prepare(std::string(kSelectRuns) + "id >= ? ORDER BY id LIMIT 2");
  if (!rows) return rows.error();
  rows->start(*id);
  const auto found = rows->next();
  if (!found) return found.error();
  if (!*found || rows->integer(0) != *id || rows->text(2) != "began")
    return fail(ErrorCode::NotFound,
                "the journal has no run of a mission " + std::to_string(*id) + " (any more)");
  Value run = run_value(*rows, Value(), "", "");
  const auto next = rows->next();
  if (!next) return next.error();
  std::int64_t last = std::int64_t{1} << 62U;
  if (*next) {
    const bool ended = rows->text(2) == "ended";
    last = rows->integer(0) - (ended ? 0 : 1);
    if (ended) {
      run.as_map().set("ended_s", seconds(rows->integer(1)));
      run.as_map().set("outcome", rows->text(6));
      run.as_map().set("error", rows->text(7));
    }
  }
  auto count = database.prepare("SELECT count(*) FROM mission WHERE id >= ? AND id <= ?");
  if (!count) return count.error();
  count->start(*id, last);
  if (const auto row = count->next(); !row) return row.error();
  auto entries = mission_entries(database, *id, last);
  if (!entries) return entries.error();
  run.as_map().set("dropped", std::max<std::int64_t>(count->integer(0) - kMostRunEntries, 0));
  run.as_map().set("entries", std::move(*entries));
  return run;
}

}  // namespace segue::journal::detail

// SPDX-License-Identifier: Apache-2.0
#include <segue/base/clock.hpp>
#include <segue/base/text.hpp>
#include <segue/journal/journal_report.hpp>
#include <segue/journal/past.hpp>
#include <segue/journal/past_missions.hpp>
#include <segue/journal/past_question.hpp>
#include <segue/journal/rows.hpp>
#include <segue/journal/schema.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace segue::journal {

namespace {

using detail::Database;
using detail::list_of;
using detail::page_asked;
using detail::seconds;
using detail::seconds_or_null;
using detail::Statement;
using detail::whole;
using detail::wrong;
using type::Value;

constexpr std::int64_t kMostMarks = 500;
constexpr std::int64_t kMostMissionEntries = 4000;
constexpr std::int64_t kMostDifferences = 50;
constexpr std::size_t kMostWords = 8;
constexpr std::size_t kLongestWords = 200;
constexpr const char* kQuestions =
    "must be 'requests', 'request', 'missions', 'mission', 'at', 'span' or 'clock'";
/// Beyond it, nanoseconds since 1970 do not fit.
constexpr double kLatest = 9e9;

Result<std::int64_t> time_asked(const Value& question) {
  const Value* value = question.find("time_s");
  const double time = value != nullptr && value->is_number() ? value->as_double() : -1;
  if (!(time >= 0) || time > kLatest) return wrong("time_s", "must be seconds since 1970");
  return static_cast<std::int64_t>(time * 1e9) + 1000;  // what a double says of a later time may be too early
}

Result<std::vector<std::string>> words_in(const Value& question) {
  const Value* value = question.find("words");
  if (value == nullptr) return std::vector<std::string>{};
  if (!value->is_string() || value->as_string().size() > kLongestWords)
    return wrong("words", "must be a text of 200 characters at most");
  std::istringstream text(value->as_string());
  std::vector<std::string> words;
  for (std::string word; text >> word;)
    words.push_back(word);
  if (words.size() > kMostWords) return wrong("words", "must be 8 words at most");
  return words;
}

Value request_in(const Statement& row) {
  return Value::map({{"id", row.integer(0)},
                     {"request", row.integer(1)},
                     {"ended_s", seconds(row.integer(2))},
                     {"lasted_s", seconds_or_null(row, 3)},
                     {"cause", row.text(4)},
                     {"who", row.text(5)},
                     {"cancelled_by", row.text(6)},
                     {"from", row.text(7)},
                     {"to", row.text(8)},
                     {"outcome", row.text(9)},
                     {"undone", row.text(10)},
                     {"error", row.text(11)},
                     {"actions", row.integer(12)}});
}

Result<Value> requests(Database& database, const Value& question) {
  const auto page = page_asked(question);
  if (!page) return page.error();
  auto words = words_in(question);
  if (!words) return words.error();
  std::string select =
      R"(SELECT id, request, time, lasted, cause, who, cancelled_by, source, target, outcome, undone, error, actions
         FROM "transition" WHERE id < ?)";
  words->resize(kMostWords);  // the empty word is everywhere
  for (std::size_t i = 0; i < kMostWords; ++i)
    select +=
        R"( AND instr(lower(source || ' ' || target || ' ' || cause || ' ' || who || ' ' || outcome || ' ' || error
            || ' ' || cancelled_by), lower(?)) > 0)";
  auto rows = database.prepare(select + " ORDER BY id DESC LIMIT ?");
  if (!rows) return rows.error();
  const auto& all = *words;
  rows->start(page->before, all[0], all[1], all[2], all[3], all[4], all[5], all[6], all[7], page->limit + 1);
  auto found = list_of(*rows, request_in);
  if (!found) return found.error();
  const bool more = found->size() > static_cast<std::size_t>(page->limit);
  if (more) found->pop_back();
  return Value::map({{"requests", std::move(*found)}, {"more", more}});
}

/// The text of a recorded network; null where none was.
Result<Value> network_of(Database& database, bool is_null, std::int64_t id) {
  if (is_null) return Value();
  auto rows = database.prepare("SELECT text FROM network WHERE id = ?");
  if (!rows) return rows.error();
  rows->start(id);
  const auto found = rows->next();
  if (!found) return found.error();
  return *found ? Value(rows->text(0)) : Value();
}

Result<Value> request(Database& database, const Value& question) {
  const auto id = whole(question, "id", 0);
  if (!id) return id.error();
  auto rows = database.prepare(std::string(detail::kSelectTransition) + " WHERE id = ?");
  if (!rows) return rows.error();
  rows->start(*id);
  const auto found = rows->next();
  if (!found) return found.error();
  if (!*found)
    return fail(ErrorCode::NotFound, "the journal has no request " + std::to_string(*id) + " (any more)");
  TransitionEntry entry = detail::transition_in(*rows);
  const auto before = network_of(database, rows->is_null(30), rows->integer(30));
  if (!before) return before.error();
  const auto after = network_of(database, rows->is_null(31), rows->integer(31));
  if (!after) return after.error();
  std::uint64_t invalid = 0;
  if (auto read = detail::read_actions(database, *id, entry, invalid); !read) return read.error();
  Value answer = to_value(entry);
  type::ValueMap& map = answer.as_map();
  map.set("id", *id);
  map.set("ended_s", seconds(rows->integer(2)));
  map.set("lasted_s", seconds_or_null(*rows, 29));
  map.set("before", *before);
  map.set("after", *after);
  return answer;
}

Result<Value> span(Database& database) {
  auto ends = database.prepare(
      R"(SELECT min(low), max(high) FROM (SELECT min(time - coalesce(lasted, 0)) AS low, max(time) AS high
         FROM "transition" UNION ALL SELECT min(time), max(time) FROM running))");
  if (!ends) return ends.error();
  ends->start();
  if (const auto row = ends->next(); !row) return row.error();
  const Value first = seconds_or_null(*ends, 0);
  const Value last = seconds_or_null(*ends, 1);
  const auto count = database.integer(R"(SELECT count(*) FROM "transition")");
  if (!count) return count.error();
  auto rows = database.prepare(
      R"(SELECT id, time, outcome FROM "transition" WHERE id % ? = 0 ORDER BY id DESC LIMIT ?)");
  if (!rows) return rows.error();
  rows->start((*count + kMostMarks - 1) / kMostMarks + (*count == 0 ? 1 : 0), kMostMarks);
  auto marks = list_of(*rows, [](const Statement& row) {
    return Value::map(
        {{"id", row.integer(0)}, {"time_s", seconds(row.integer(1))}, {"outcome", row.text(2)}});
  });
  if (!marks) return marks.error();
  std::reverse(marks->begin(), marks->end());
  return Value::map({{"first_s", first}, {"last_s", last}, {"marks", std::move(*marks)}});
}

/// The journal's record of one time.
class Moment {
 public:
  Moment(Database& database, std::int64_t time) : database_(database), time_(time) {}

  Result<Value> describe() {
    for (const auto find : {&Moment::find_evidence, &Moment::find_transition, &Moment::find_end,
                            &Moment::find_gaps, &Moment::find_differences, &Moment::find_missions}) {
      if (auto done = (this->*find)(); !done) return done.error();
    }
    const bool known = !network_.is_null();
    if (!known && notes_.empty()) notes_.emplace_back("what ran then was not recorded");
    return Value::map({{"time_s", seconds(time_)},
                       {"known", known},
                       {"since_s", since_ == 0 ? Value() : Value(seconds(since_))},
                       {"controller", known ? Value(controller_) : Value()},
                       {"version", known ? Value(version_) : Value()},
                       {"network", network_},
                       {"transition", transition_},
                       {"missions", std::move(missions_)},
                       {"differences", std::move(differences_)},
                       {"notes", std::move(notes_)}});
  }

 private:
  /// A started statement with its first row; nothing: it has none.
  template <class... Values>
  Result<std::optional<Statement>> first_row(std::string_view sql, const Values&... values) {
    auto rows = database_.prepare(sql);
    if (!rows) return rows.error();
    rows->start(values...);
    const auto found = rows->next();
    if (!found) return found.error();
    return *found ? std::optional<Statement>(std::move(*rows)) : std::nullopt;
  }

  /// The last entry before that time that says which network ran.
  Result<void> find_evidence() {
    auto row = first_row(
        R"(SELECT time, runs, runs_version, after, 0 FROM "transition" WHERE time <= ? AND after IS NOT NULL
           UNION ALL SELECT time, controller, '', network, 1 FROM running WHERE kind = 'began' AND time <= ?
           ORDER BY 1 DESC, 5 LIMIT 1)",
        time_, time_);
    if (!row) return row.error();
    if (!*row) {
      notes_.emplace_back("nothing was recorded before that time of what ran");
      return {};
    }
    since_ = (*row)->integer(0);
    controller_ = (*row)->text(1);
    version_ = (*row)->text(2);
    auto network = network_of(database_, (*row)->is_null(3), (*row)->integer(3));
    if (!network) return network.error();
    network_ = std::move(*network);
    return {};
  }

  /// The transition in progress; until it has ended, no other entry says which network runs.
  Result<void> find_transition() {
    auto row = first_row(
        R"(SELECT id, before, source, source_version FROM "transition"
           WHERE time > ? AND lasted IS NOT NULL AND time - lasted <= ? AND before IS NOT NULL
           ORDER BY time LIMIT 1)",
        time_, time_);
    if (!row) return row.error();
    if (!*row) return {};
    transition_ = Value((*row)->integer(0));
    auto network = network_of(database_, (*row)->is_null(1), (*row)->integer(1));
    if (!network) return network.error();
    network_ = std::move(*network);
    controller_ = (*row)->text(2);
    version_ = (*row)->text(3);
    return {};
  }

  /// Whether the runtime still observed the robot.
  Result<void> find_end() {
    if (since_ == 0) return {};
    auto ended = first_row(
        "SELECT time FROM running WHERE kind = 'ended' AND time <= ? AND time >= ? LIMIT 1", time_, since_);
    if (!ended) return ended.error();
    if (*ended) {
      network_ = Value();
      transition_ = Value();
      notes_.emplace_back("the runtime had ended; what its processes did without it was not recorded");
      return {};
    }
    auto next = first_row("SELECT kind FROM running WHERE time > ? ORDER BY time LIMIT 1", time_);
    if (!next) return next.error();
    if (*next && (*next)->text(0) == "began")
      notes_.emplace_back("the runtime ended without a record of it, maybe before that time");
    return {};
  }

  /// Entries that were lost since then may have said something else. A gap has the time when writing resumed.
  Result<void> find_gaps() {
    auto gap = first_row(
        R"(SELECT lost, reason FROM gap WHERE time >= ? AND time <= coalesce(
             (SELECT min(time) FROM "transition" WHERE time > ?), time) ORDER BY time LIMIT 1)",
        since_, time_);
    if (!gap) return gap.error();
    if (*gap)
      notes_.emplace_back(std::to_string((*gap)->integer(0)) +
                          " entries around that time were lost: " + (*gap)->text(1));
    return {};
  }

  Result<void> find_differences() {
    auto rows = database_.prepare(
        "SELECT sentence, done FROM difference WHERE time >= ? AND time <= ? ORDER BY id DESC LIMIT ?");
    if (!rows) return rows.error();
    rows->start(since_, time_, kMostDifferences);
    auto found = list_of(*rows, [](const Statement& row) {
      const std::string done = row.text(1);
      return Value(row.text(0) + (done.empty() ? "" : ": " + done));
    });
    if (!found) return found.error();
    differences_ = std::move(*found);
    std::reverse(differences_.begin(), differences_.end());
    return {};
  }

  Result<void> find_missions() {
    auto began = first_row("SELECT max(time) FROM running WHERE kind = 'began' AND time <= ?", time_);
    if (!began) return began.error();
    auto rows = database_.prepare(
        R"(SELECT kind, who, mission, action, iteration FROM (SELECT * FROM mission WHERE time >= ? AND time <= ?
           ORDER BY id DESC LIMIT ?) ORDER BY id)");
    if (!rows) return rows.error();
    rows->start(*began ? (*began)->integer(0) : std::int64_t{0}, time_, kMostMissionEntries);
    std::map<std::pair<std::string, std::string>, std::map<std::string, int>> running;
    while (true) {
      const auto more = rows->next();
      if (!more) return more.error();
      if (!*more) break;
      follow(*rows, running);
    }
    for (const auto& [mission, actions] : running) {
      Value::List names;
      for (const auto& [action, count] : actions) {
        if (count > 0 && names.size() < 100) names.emplace_back(action);
      }
      missions_.push_back(
          Value::map({{"mission", mission.first}, {"who", mission.second}, {"actions", std::move(names)}}));
    }
    return {};
  }

  template <class Running>
  static void follow(const Statement& row, Running& running) {
    const std::string kind = row.text(0);
    const std::string action = row.text(3);
    const auto mission = std::pair(row.text(2), row.text(1));
    if (kind == "began" && !action.empty()) ++running[mission][action];
    if (kind == "began" && action.empty()) running[mission];
    const auto found = running.find(mission);
    if (kind != "ended" || found == running.end()) return;
    if (action.empty()) {
      running.erase(found);
    } else {
      --found->second[action];
    }
  }

  Database& database_;
  const std::int64_t time_;
  std::int64_t since_ = 0;
  std::string controller_;
  std::string version_;
  Value network_;
  Value transition_;
  Value::List missions_;
  Value::List differences_;
  Value::List notes_;
};

Result<Value> answer(Database& database, const std::string& ask, const Value& question) {
  if (ask == "requests") return requests(database, question);
  if (ask == "request") return request(database, question);
  if (ask == "missions") return detail::missions(database, question);
  if (ask == "mission") return detail::mission(database, question);
  if (ask == "span") return span(database);
  if (ask != "at") return wrong("ask", kQuestions);
  const auto time = time_asked(question);
  return time ? Moment(database, *time).describe() : Result<Value>(time.error());
}

}  // namespace

Result<Value> answer_about_past(const std::filesystem::path& path, const Value& question) {
  const Value* ask = question.is_map() ? question.find("ask") : nullptr;
  if (ask == nullptr || !ask->is_string()) return wrong("ask", kQuestions);
  if (ask->as_string() == "clock") {
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    return Value::map({{"now_s", seconds(std::chrono::duration_cast<Duration>(now).count())}});
  }
  std::error_code failed;
  if (!std::filesystem::exists(path, failed))
    return fail(ErrorCode::NotFound, "there is no journal " + quote(path.native()));
  const auto about = [&](Error inner) {
    inner.message = "cannot read the journal " + quote(path.native()) + ": " + inner.message;
    return inner;
  };
  auto database = Database::open(path, Database::Mode::Read);
  if (!database) return about(database.error());
  if (auto fits = detail::check_schema(*database); !fits) return about(fits.error());
  // One state of the file for several statements, whatever is written meanwhile.
  if (auto begun = database->execute("BEGIN"); !begun) return about(begun.error());
  return answer(*database, ask->as_string(), question);
}

}  // namespace segue::journal

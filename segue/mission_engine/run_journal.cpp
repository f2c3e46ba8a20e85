// SPDX-License-Identifier: Apache-2.0
#include <segue/base/fnv1a.hpp>
#include <segue/mission_engine/run_journal.hpp>

#include <segue/base/error.hpp>
#include <segue/base/text.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/type/value_at.hpp>

#include <algorithm>
#include <charconv>
#include <system_error>

namespace segue::mission {

namespace {

using type::Value;
using type::ValueMap;

/// The digest of the mission with its libraries; script files are not included, so that they can be
/// corrected.
std::string digest(const Mission& mission) {
  return std::to_string(fnv1a(write_mission(mission)));
}

const Value& part(const Value& line, std::string_view key) {
  static const Value kNothing;
  const Value* found = line.find(key);
  return found == nullptr ? kNothing : *found;
}

bool flag_of(const Value& line, std::string_view key) {
  const Value& value = part(line, key);
  return value.is_bool() && value.as_bool();
}

ValueMap map_of(const Value& line, std::string_view key) {
  const Value& value = part(line, key);
  return value.is_map() ? value.as_map() : ValueMap();
}

std::vector<std::string> texts_of(const Value& line, std::string_view key) {
  std::vector<std::string> texts;
  const Value& value = part(line, key);
  for (const Value& one : value.is_list() ? value.as_list() : Value::List()) {
    if (one.is_string()) texts.push_back(one.as_string());
  }
  return texts;
}

Value list(const std::vector<std::string>& texts) {
  return Value::List(texts.begin(), texts.end());
}

Value counts_value(const UnitCounts& counts) {
  ValueMap map;
  for (const auto& [resource, count] : counts)
    map.set(resource, static_cast<std::uint64_t>(count));
  return map;
}

UnitCounts counts_of(const Value& line) {
  UnitCounts counts;
  for (const auto& [resource, count] : unit_changes(map_of(line, "resources")))
    counts.emplace_back(resource, static_cast<std::uint32_t>(count));
  return counts;
}

/// The fields that begin the line of an event.
ValueMap event(const std::string& kind, const Execution& execution) {
  ValueMap line;
  line.append(kind, execution.path);
  line.append("n", execution.iteration);
  if (!execution.loops.empty()) line.append("loops", execution.loops);
  return line;
}

std::string count_of_ended(std::size_t count) {
  return counted(count, "action") + " had ended";
}

std::string cut_text(const RunJournalFile::Contents& contents) {
  return "the end of the journal was damaged, as an interruption leaves it: " +
         counted(contents.cut, "line") + " behind " +
         (contents.entries.empty() ? "its beginning" : "entry " + std::to_string(contents.entries.size())) +
         (contents.cut == 1 ? " was" : " were") + " cut off";
}

}  // namespace

Value to_value(const std::map<StateIndex, std::uint32_t>& counts) {
  ValueMap map;
  for (const auto& [state, count] : counts)
    map.append(std::to_string(state), static_cast<std::uint64_t>(count));
  return map;
}

std::map<StateIndex, std::uint32_t> counts_by_state(const ValueMap& map) {
  std::map<StateIndex, std::uint32_t> counts;
  for (const auto& [name, count] : map) {
    StateIndex state = 0;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), state);
    if (error == std::errc() && *end == 0 && count.is_integer())
      counts[state] = static_cast<std::uint32_t>(count.as_int());
  }
  return counts;
}

Result<std::unique_ptr<RunJournal>> RunJournal::create(const std::filesystem::path& file,
                                                       const Mission& mission, Start start, Warn warn) {
  ValueMap line;
  line.append("mission", mission.name);
  line.append("digest", digest(mission));
  line.append("inputs", start.inputs);
  line.append("facts", list(start.facts));
  line.append("start_at", start.start_at);
  if (start.concurrent) line.append("concurrent", true);
  if (!start.resources.empty()) line.append("resources", counts_value(start.resources));
  if (start.seed != 0) line.append("seed", start.seed);
  auto created = RunJournalFile::create(file, line, std::move(warn));
  if (!created) return created.error();
  std::unique_ptr<RunJournal> journal(new RunJournal(std::move(*created)));
  journal->start_ = std::move(start);
  return journal;
}

Result<std::unique_ptr<RunJournal>> RunJournal::resume(const std::filesystem::path& file,
                                                       const Mission& mission, bool concurrent,
                                                       UnderWay under_way, const Warn& warn,
                                                       const CanGoOn& can_go_on) {
  auto opened = RunJournalFile::open(file, warn);
  if (!opened) return opened.error();
  std::unique_ptr<RunJournal> journal(new RunJournal(std::move(*opened)));
  const auto contents = journal->file_->take_contents();
  if (auto taken = journal->read(contents, mission); !taken) return taken.error();
  if (journal->start_.concurrent != concurrent) {
    return fail(ErrorCode::InvalidArgument, concurrent ? "that run was a sequential one: --mode sequential"
                                                       : "that run was a concurrent one: --mode concurrent");
  }
  if (journal->finished_) return fail(ErrorCode::InvalidState, "that run has ended; start a new one");
  if (const std::string open = journal->open_actions(); under_way == UnderWay::Refuse && !open.empty()) {
    return fail(
        ErrorCode::InvalidState,
        open +
            " had begun but not ended when the run was interrupted; choose what to do about it: --under-way "
            "again, skip or abort");
  }
  if (under_way == UnderWay::GoOn) {
    if (auto goes_on = journal->go_on(mission, can_go_on); !goes_on) return goes_on.error();
  }
  if (auto goes_on = journal->file_->continue_after_contents(); !goes_on) return goes_on.error();
  if (contents.cut > 0 && warn) warn(cut_text(contents));
  journal->under_way_ = under_way;
  return journal;
}

Result<void> RunJournal::read(const RunJournalFile::Contents& contents, const Mission& mission) {
  const Value& first = contents.first;
  if (text_at(first, "digest") != digest(mission)) {
    return fail(ErrorCode::InvalidArgument, "the run was one of " + quote(text_at(first, "mission")) +
                                                " as it was then; this mission is another one");
  }
  start_ = {map_of(first, "inputs"), texts_of(first, "facts"), text_at(first, "start_at"),
            flag_of(first, "concurrent"), counts_of(first)};
  if (const Value& seed = part(first, "seed"); seed.is_integer()) start_.seed = seed.as_uint();
  for (const Value& entry : contents.entries) {
    if (auto taken = take(entry); !taken)
      return fail(ErrorCode::ParseError, "the journal cannot be read: " + taken.error().message);
  }
  if (!contents.refusal) return {};
  return fail(ErrorCode::ParseError, "the journal is damaged: " + *contents.refusal +
                                         ", so nobody knows what the run has done since; until then " +
                                         known_text() + "; start a new run");
}

/// "2 actions had ended, the last of them 'look', and 'grasp' had begun"
std::string RunJournal::known_text() const {
  std::string text = count_of_ended(ends_.size());
  if (const auto last = std::ranges::max_element(places_, {}, [](const auto& one) { return one.second; });
      last != places_.end())
    text += ", the last of them " + quote(last->first.path);
  const std::string open = open_actions();
  return open.empty() ? text : text + ", and " + open + " had begun";
}

Result<void> RunJournal::take(const Value& line) {
  if (line.find("finished") != nullptr) {
    finished_ = true;
    return {};
  }
  const Value& n = part(line, "n");
  if (!n.is_integer()) return fail(ErrorCode::ParseError, "the number of the execution is missing");
  if (const Value* path = line.find("begun"); path != nullptr && path->is_string()) {
    open_[{path->as_string(), n.as_uint(), text_at(line, "loops")}] = {
        flag_of(line, "irreversible"), text_at(line, "action"), {}};
    return {};
  }
  if (const Value* path = line.find("progressed"); path != nullptr && path->is_string()) {
    const auto open = open_.find({path->as_string(), n.as_uint(), text_at(line, "loops")});
    if (open != open_.end()) open->second.progress = part(line, "to");
    return {};
  }
  if (const Value* path = line.find("first"); path != nullptr && path->is_string()) {
    firsts_.insert({path->as_string(), n.as_uint(), text_at(line, "loops")});
    return {};
  }
  const Value* path = line.find("ended");
  const Value& outcome = part(line, "outcome");
  if (path == nullptr || !path->is_string() || !outcome.is_integer())
    return fail(ErrorCode::ParseError, "it records neither a begin nor an end");
  const Value& outputs = part(line, "outputs");
  End end{static_cast<Outcome>(outcome.as_int()),
          text_at(line, "error"),
          flag_of(line, "preempted"),
          outputs.is_list() ? outputs.as_list() : Value::List(),
          map_of(line, "globals"),
          texts_of(line, "erased"),
          texts_of(line, "facts"),
          unit_changes(map_of(line, "units")),
          counts_by_state(map_of(line, "states")),
          map_of(line, "values")};
  const Execution execution{path->as_string(), n.as_uint(), text_at(line, "loops")};
  open_.erase(execution);
  if (!places_.emplace(execution, ends_.size()).second)
    return fail(ErrorCode::ParseError, quote(execution.path) + " ends twice");
  ends_.push_back(std::move(end));
  return {};
}

std::string RunJournal::open_actions() const {
  std::vector<std::string> names;
  for (const auto& [execution, open] : open_) {
    if (open.irreversible) names.push_back(quote(execution.path));
  }
  return names.empty() ? std::string() : listed(names);
}

Result<void> RunJournal::go_on(const Mission& mission, const CanGoOn& can_go_on) {
  for (const auto& [execution, open] : open_) {
    if (!open.irreversible) continue;
    const auto action = std::ranges::find(mission.actions, open.action,
                                          [](const Action& one) { return std::string_view(one.name.str()); });
    const bool known = action != mission.actions.end() && can_go_on;
    const auto can = known ? can_go_on(*action, open.progress)
                           : fail(ErrorCode::Unsupported, "nobody can see how far it got");
    if (can) continue;
    return fail(ErrorCode::InvalidState,
                quote(execution.path) +
                    " had begun but not ended when the run was interrupted, and cannot go on: " +
                    can.error().message + "; choose what to do about it: --under-way again, skip or abort");
  }
  return {};
}

const Value& RunJournal::progress(const Execution& execution) const {
  static const Value kNone;
  const auto found = under_way_ == UnderWay::GoOn ? open_.find(execution) : open_.end();
  return found == open_.end() ? kNone : found->second.progress;
}

std::set<Execution> RunJournal::executions() const {
  std::set<Execution> recorded;
  for (const auto& [execution, place] : places_)
    recorded.insert(execution);
  return recorded;
}

std::optional<std::size_t> RunJournal::find(const Execution& execution) const {
  const auto found = places_.find(execution);
  return found == places_.end() ? std::nullopt : std::optional(found->second);
}

std::optional<RunJournal::End> RunJournal::assumed_end(const Execution& execution,
                                                       const Action& action) const {
  const auto found = open_.find(execution);
  if (found == open_.end() || !found->second.irreversible) return std::nullopt;
  End end;
  if (under_way_ == UnderWay::Abort) {
    end.outcome = kAborted;
    end.error = "it had begun but not ended when the earlier run was interrupted";
    return end;
  }
  if (under_way_ != UnderWay::Skip) return std::nullopt;
  const auto expected = std::ranges::find(action.outcomes, action.foreseen_outcome());
  if (expected != action.outcomes.end())
    end.outcome = static_cast<Outcome>(expected - action.outcomes.begin());
  return end;
}

void RunJournal::began(const Execution& execution, bool irreversible, std::string_view action) {
  if (!progress(execution).is_null()) return;  // it goes on
  ValueMap line = event("begun", execution);
  if (irreversible) line.append("irreversible", true);
  if (irreversible && !action.empty()) line.append("action", action);
  file_->add(line, irreversible);
}

void RunJournal::progressed(const Execution& execution, const Value& progress) {
  ValueMap line = event("progressed", execution);
  line.append("to", progress);
  file_->add(line, true);
}

void RunJournal::close() {
  is_closed_ = true;
  file_->close();
}

void RunJournal::ended(const Execution& execution, const End& end) {
  ValueMap line = event("ended", execution);
  line.append("outcome", static_cast<std::int64_t>(end.outcome));
  if (!end.error.empty()) line.append("error", end.error);
  if (end.preempted) line.append("preempted", true);
  line.append("outputs", Value::List(end.outputs));
  if (!end.globals.empty()) line.append("globals", end.globals);
  if (!end.erased.empty()) line.append("erased", list(end.erased));
  if (!end.facts.empty()) line.append("facts", list(end.facts));
  if (!end.units.empty()) line.append("units", to_value(end.units));
  if (!end.begun.empty()) line.append("states", to_value(end.begun));
  if (!end.values.empty()) line.append("values", end.values);
  file_->add(line, false);
}

void RunJournal::ended(const Execution& execution, End end, const Value& globals) {
  const auto& now = globals.as_map();
  for (const auto& [name, value] : now) {
    const Value* before = globals_.is_map() ? globals_.find(name) : nullptr;
    if (before == nullptr || !(*before == value)) end.globals.append(name, value);
  }
  for (const auto& [name, value] : globals_.is_map() ? globals_.as_map() : ValueMap()) {
    if (now.find(name) == nullptr) end.erased.push_back(name);
  }
  globals_ = globals;
  ended(execution, end);
}

void RunJournal::first(const Execution& execution) {
  file_->add(event("first", execution), false);
}

void RunJournal::finished(const std::string& outcome) {
  ValueMap line;
  line.append("finished", outcome);
  file_->add(line, true);
}

}  // namespace segue::mission

// SPDX-License-Identifier: Apache-2.0
#include <segue/control/server.hpp>
#include <segue/journal/journal_reader.hpp>
#include <segue/journal/journal_report.hpp>

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <memory>

#include "../connection.hpp"
#include "../estimate_text.hpp"
#include "../journal_file.hpp"
#include "../report_text.hpp"
#include "history_missions.hpp"
#include "history_slowest.hpp"

namespace segue::cli {

namespace {

using type::Value;

struct HistoryOptions {
  std::string journal;
  bool all = false;
  bool differences = false;
  bool versions = false;
  bool missions = false;
  bool slowest = false;
  std::size_t lines = 0;  ///< 0: all
};

/// "2026-11-22 01:02:03" of an ISO time.
std::string short_time(const std::string& time) {
  std::string text = time.substr(0, 19);
  std::replace(text.begin(), text.end(), 'T', ' ');
  return text.empty() ? text : text + "  ";
}

/// "; version 3f2a9c81d0b2 since then" where the robot runs another version after it.
std::string version_of(const Value& result) {
  const std::string version = printable_at(result, "runs_version");
  if (version.empty() || version == printable_at(result, "from_version")) return {};
  return fmt::format("; version {}", printable(version));
}

void show_transitions(const Value::List& results, bool with_time) {
  Forecasts forecasts;
  double saved = 0;
  std::size_t prepared = 0;
  for (const Value& result : results) {
    forecasts.add(result);
    if (const Value* ahead = result.find("ahead")) {
      saved += number_at(*ahead, "saved_s");
      ++prepared;
    }
    print_line((with_time ? short_time(printable_at(result, "time")) : "") + printable(outcome_line(result)) +
               version_of(result) + expectation_of(result) + saving_of(result));
  }
  const std::string verdict = forecasts.verdict();
  if (!verdict.empty()) print_line(verdict);
  if (prepared > 0) print_line(saving_line(saved, prepared));
}

int show_running(control::RobotService& robot, const HistoryOptions& options, const Context& context) {
  auto found = robot.history();
  if (!found) return failed(context, found.error());
  Value::List results = found->is_list() ? found->as_list() : Value::List();
  if (options.lines > 0 && results.size() > options.lines) {
    results.erase(results.begin(), results.end() - static_cast<std::ptrdiff_t>(options.lines));
  }
  if (context.json()) {
    print_json(results);
  } else if (results.empty()) {
    print_line("nothing has been requested yet; try `segue switch NAME`");
  } else {
    show_transitions(results, false);
  }
  return kDone;
}

template <class Entry>
Value::List as_values(const std::vector<Entry>& entries) {
  Value::List values;
  for (const Entry& entry : entries)
    values.push_back(journal::to_value(entry));
  return values;
}

int show_differences(journal::JournalReader& reader, std::size_t limit, const Context& context) {
  const auto found = reader.differences(limit);
  if (!found) return failed(context, found.error());
  if (context.json()) {
    print_json(as_values(*found));
    return kDone;
  }
  if (found->empty()) print_line("no drift was ever found");
  for (const Value& entry : as_values(*found)) {
    const std::string done = printable_at(entry, "done");
    print_line(short_time(printable_at(entry, "time")) + printable_at(entry, "sentence") +
               (done.empty() ? "" : ": " + printable(done)));
  }
  return kDone;
}

int show_versions(journal::JournalReader& reader, std::size_t limit, const Context& context) {
  const auto found = reader.versions(limit);
  if (!found) return failed(context, found.error());
  if (context.json()) {
    print_json(as_values(*found));
    return kDone;
  }
  if (found->empty()) print_line("no controller was ever loaded");
  for (const Value& entry : as_values(*found)) {
    print_line(fmt::format("{}{} {} ({})", short_time(printable_at(entry, "time")),
                           printable_at(entry, "controller"), printable_at(entry, "version"),
                           printable_at(entry, "file")));
  }
  return kDone;
}

int show_missions(journal::JournalReader& reader, std::size_t limit, const Context& context) {
  const auto found = what_happened(reader, limit);
  if (!found) return failed(context, found.error());
  if (context.json()) {
    print_json(*found);
    return kDone;
  }
  if (found->empty()) print_line("nothing has happened yet");
  for (const Value& entry : *found)
    print_line(short_time(printable_at(entry, "time")) + printable(happened_line(entry)));
  return kDone;
}

/// Entries that could not be recorded are missing from the history, which a reader must know.
void warn_of_gaps(journal::JournalReader& reader) {
  const auto gaps = reader.gaps(std::numeric_limits<std::size_t>::max());
  if (!gaps) return;
  for (const journal::GapEntry& gap : *gaps) {
    const Value entry = journal::to_value(gap);
    print_note(fmt::format("before {}{} could not be recorded: {}", short_time(printable_at(entry, "time")),
                           gap.lost == 1 ? "1 entry" : fmt::format("{} entries", gap.lost),
                           printable(gap.reason)));
  }
}

/// Of all transitions in the journal; `-n` is the number of actions.
int show_slowest(journal::JournalReader& reader, const HistoryOptions& options, const Context& context) {
  constexpr std::size_t kUsualLines = 20;
  const auto entries = reader.transitions(std::numeric_limits<std::size_t>::max());
  if (!entries) return failed(context, entries.error());
  const auto actions = slowest_actions(*entries, options.lines > 0 ? options.lines : kUsualLines);
  if (context.json()) {
    print_json(slowest_value(actions));
  } else if (actions.empty()) {
    print_line("no action was ever executed");
  } else {
    print(slowest_text(actions));
  }
  warn_of_gaps(reader);
  return kDone;
}

int show_journal(const std::filesystem::path& path, const HistoryOptions& options, const Context& context) {
  auto reader = journal::JournalReader::open(path);
  if (!reader) return failed(context, reader.error());
  const std::size_t limit = options.lines > 0 ? options.lines : std::numeric_limits<std::size_t>::max();
  if (options.differences) return show_differences(*reader, limit, context);
  if (options.versions) return show_versions(*reader, limit, context);
  if (options.slowest) return show_slowest(*reader, options, context);
  if (options.missions) {
    const int status = show_missions(*reader, limit, context);
    warn_of_gaps(*reader);
    return status;
  }
  const auto entries = reader->transitions(limit);
  if (!entries) return failed(context, entries.error());
  if (context.json()) {
    print_json(as_values(*entries));
  } else if (entries->empty()) {
    print_line("nothing has been requested yet");
  } else {
    show_transitions(as_values(*entries), true);
  }
  warn_of_gaps(*reader);
  return kDone;
}

/// Whether the robot of --robot is running; without --robot, whether any is.
bool is_running(const std::string& robot) {
  const auto running = control::running_robots();
  return robot.empty() ? !running.empty() : std::find(running.begin(), running.end(), robot) != running.end();
}

/// The robot of --robot, or the only one that is running; otherwise empty.
std::string robot_meant(const Context& context) {
  if (!context.robot.empty()) return context.robot;
  const auto running = control::running_robots();
  return running.size() == 1 ? running.front() : std::string();
}

/// Has a running robot write to its journal what has happened so far, before that is read.
void complete_journal(const std::string& robot) {
  const auto running = connect_to(robot);
  if (running) static_cast<void>((*running)->past(Value::map({{"ask", "span"}})));
}

int show_history(const HistoryOptions& options, Context& context) {
  const bool wants_file = options.all || options.differences || options.versions || options.missions ||
                          options.slowest || !options.journal.empty();
  const auto path = find_journal(options.journal, robot_meant(context));
  const bool is_there = path && std::filesystem::exists(*path);
  if (!wants_file && (is_running(context.robot) || !is_there)) {
    return with_robot(context,
                      [&](control::RobotService& robot) { return show_running(robot, options, context); });
  }
  if (!path) return failed(context, path.error());
  if (options.journal.empty() && is_running(robot_meant(context))) complete_journal(robot_meant(context));
  return show_journal(*path, options, context);
}

}  // namespace

void add_history(Verb& app, Context& context) {
  const auto options = std::make_shared<HistoryOptions>();
  Verb& verb = add_verb(
      app, context, "history", "list past requests and their durations",
      "  segue history\n"
      "  segue history --all --robot artemis      # all requests ever, whether or not it is running\n"
      "  segue history --missions -n 40           # the latest that missions and the robot did\n"
      "  segue history --slowest -n 10            # the actions of all transitions that took longest\n\n"
      "For a running robot, these are the requests since it was started. If it is not running, and with "
      "--all,\n"
      "the robot's journal is read. 'expected' is the prediction made from the durations measured before.\n"
      "A version is the first 12 digits of a network file's SHA-256.",
      [options, &context] { return show_history(*options, context); });
  add_robot_option(verb, context);
  verb.flag("--all", options->all, "show everything in the robot's journal");
  add_journal_option(verb, options->journal);
  const Option differences =
      verb.flag("--differences", options->differences, "show the drift recorded in the journal instead");
  const Option versions = verb.flag("--versions", options->versions,
                                    "show the versions of controllers recorded in the journal instead")
                              .excludes(differences);
  const Option missions =
      verb.flag("--missions", options->missions,
                "show what missions did as well, in the order in which it happened, from the journal")
          .excludes(differences)
          .excludes(versions);
  verb.flag("--slowest", options->slowest,
            "show the actions that took longest, from the journal, with hints for who wrote the component")
      .excludes(differences)
      .excludes(versions)
      .excludes(missions);
  verb.option("-n,--lines N", options->lines, "show the latest N only").between(1, kMostLines);
}

}  // namespace segue::cli

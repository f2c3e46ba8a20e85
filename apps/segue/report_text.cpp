// SPDX-License-Identifier: Apache-2.0
#include "report_text.hpp"

#include <segue/base/text.hpp>
#include <segue/model/files.hpp>

#include <fmt/core.h>

#include <cstdio>
#include <string_view>

#include "estimate_text.hpp"
#include "output.hpp"

namespace segue::cli {

namespace {

using type::Value;

std::string name_or_empty(const std::string& name) {
  return name.empty() ? std::string(kEmptyNetwork) : name;
}

std::string phase_text(const Value& transition, std::string_view phase) {
  std::string text;
  std::size_t count = 0;
  for (const Value& action : list_at(transition, "actions")) {
    if (printable_at(action, "phase") != phase) continue;
    ++count;
    text += fmt::format("{:>5}  {:<14} {}\n", number_at(action, "id"), printable_at(action, "kind"),
                        action_label(action).substr(printable_at(action, "kind").size() + 1));
  }
  if (count == 0) return {};
  return coloured(Colour::Bold, fmt::format("{} ({})", phase, count)) + '\n' + text;
}

std::string counts_text(const Value& counts) {
  std::string text;
  for (const auto kind : model::kActionKindNames) {
    const double count = number_at(counts, kind);
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", kind, count);
  }
  return text;
}

std::string actions_text(const Value& result) {
  Table table({{"STARTED", Table::Align::Right}, {"TOOK", Table::Align::Right}, {"ACTION"}, {"OUTCOME"}});
  for (const Value& action : list_at(result, "actions")) {
    const std::string outcome = printable_at(action, "outcome");
    const std::string error = printable_at(action, "error");
    const Colour colour = outcome == "done" ? Colour::Green : outcome == "failed" ? Colour::Red : Colour::Dim;
    table.add({format_seconds(number_at(action, "started_s")),
               format_seconds(number_at(action, "duration_s")), action_label(action),
               coloured(colour, outcome) + (error.empty() ? "" : ": " + error)});
  }
  return list_at(result, "actions").empty() ? std::string() : table.text();
}

Colour colour_of(const std::string& kind) {
  if (kind.find("failed") != std::string::npos || kind.find("refused") != std::string::npos)
    return Colour::Red;
  if (kind.find("difference") != std::string::npos || kind.find("superseded") != std::string::npos) {
    return Colour::Yellow;
  }
  return kind.find("done") != std::string::npos ? Colour::Green : Colour::Blue;
}

}  // namespace

std::string action_label(const Value& action) {
  const std::string kind = printable_at(action, "kind");
  const std::string task = printable_at(action, "task");
  if (kind == "connect" || kind == "disconnect") {
    const std::string policy = printable_at(action, "policy");
    const std::string suffix = policy.empty() || policy == "data" ? "" : " (" + policy + ")";
    return fmt::format("{} {} -> {}{}", kind, printable_at(action, "from"), printable_at(action, "to"),
                       suffix);
  }
  if (kind == "hand_over")
    return fmt::format("{} {} -> {}", kind, printable_at(action, "from"), printable_at(action, "to"));
  if (kind == "deploy" || kind == "undeploy") {
    return fmt::format("{} {}/{}", kind, printable_at(action, "host"), printable_at(action, "process"));
  }
  if (kind == "call_operation") return fmt::format("{} {}.{}", kind, task, printable_at(action, "operation"));
  return fmt::format("{} {}", kind, task);
}

std::string describe_transition(const Value& transition) {
  static const Value none;
  const Value* counts = transition.find("counts");
  const Value& numbers = counts != nullptr ? *counts : none;
  const auto total = static_cast<std::size_t>(number_at(numbers, "total"));
  std::string text = fmt::format("{} -> {}: ", name_or_empty(printable_at(transition, "from")),
                                 name_or_empty(printable_at(transition, "to")));
  if (total == 0) return text + "nothing to do\n";
  text += fmt::format("{}, {} of them state changes; order {}\n", counted(total, "action"),
                      number_at(numbers, "state_changes"), printable_at(transition, "order"));
  for (const auto phase : model::kPhaseNames)
    text += phase_text(transition, phase);
  return text + "total: " + counts_text(numbers) + '\n' + estimate_text(transition);
}

std::string changes_of(const Value& transition) {
  const auto& changes = list_at(transition, "changes");
  std::string text;
  for (const Value& change : changes) {
    if (change.is_string()) text += "    " + printable(change.as_string()) + '\n';
  }
  return text.empty() ? text
                      : coloured(Colour::Bold, fmt::format("changes ({})", changes.size())) + '\n' + text;
}

std::string outcome_line(const Value& result) {
  std::size_t done = 0;
  for (const Value& action : list_at(result, "actions"))
    done += printable_at(action, "outcome") == "done" ? 1U : 0U;
  const std::string cause = printable_at(result, "cause");
  const std::string why = cause.empty() || cause == "request" ? "" : " (" + cause + ")";
  std::string line =
      fmt::format("{} -> {}{}: {}", name_or_empty(printable_at(result, "from")),
                  name_or_empty(printable_at(result, "to")), why, printable_at(result, "outcome"));
  if (list_at(result, "actions").empty()) return line;
  const std::string leftover = printable_at(result, "leftover").empty() ? "" : ", retire incomplete";
  return line + fmt::format(", {} in {} (commit {}){}", counted(done, "action"),
                            format_seconds(number_at(result, "duration_s")),
                            format_seconds(number_at(result, "commit_s")), leftover);
}

std::string saving_of(const Value& result) {
  const Value* ahead = result.find("ahead");
  if (ahead == nullptr) return {};
  const auto tasks = static_cast<std::size_t>(number_at(*ahead, "tasks"));
  return fmt::format("; look-ahead saved {} ({} {} ready)", format_seconds(number_at(*ahead, "saved_s")),
                     counted(tasks, "task"), tasks == 1 ? "was" : "were");
}

std::string saving_line(double seconds, std::size_t transitions) {
  return fmt::format("Look-ahead saved {} of {}.", format_seconds(seconds),
                     counted(transitions, "transition"));
}

std::string outcome_text(const Value& result) {
  const bool done = printable_at(result, "outcome") == "done";
  return actions_text(result) + coloured(done ? Colour::Green : Colour::Red, outcome_line(result)) + '\n';
}

namespace {

int whole_at(const Value& map, std::string_view key) {
  return static_cast<int>(number_at(map, key));
}

/// An error without the finding that it ends with, which is the first of several ("... (and 2 more)").
std::string without_finding(const std::string& error, const std::string& finding) {
  const auto at = error.find(finding);
  if (at == std::string::npos) return error;
  const std::string before = error.substr(0, at);
  return before.ends_with(": ") ? before.substr(0, before.size() - 2) : before;
}

}  // namespace

void print_reasons(const Value& result) {
  std::string error = printable_at(result, "error");
  for (const Value& item : list_at(result, "diagnostics")) {
    const std::string where = to_string(
        SourceLocation{printable_at(item, "file"), whole_at(item, "line"), whole_at(item, "column")});
    const std::string prefix = where.empty() ? "" : where + ": ";
    const std::string message = printable_at(item, "message");
    print_error_line(prefix + printable_at(item, "severity") + ": " + message);
    error = without_finding(error, prefix + message);
  }
  if (!error.empty()) print_error_line("segue: error: " + error);
  const std::string leftover = printable_at(result, "leftover");
  if (!leftover.empty()) print_error_line("segue: warning: " + leftover);
}

int show_outcome(const Value& result, const Context& context) {
  const bool done = printable_at(result, "outcome") == "done";
  if (context.json()) {
    print_json(result);
  } else {
    print(outcome_text(result));
  }
  print_reasons(result);
  return done ? kDone : kFailed;
}

std::string event_line(const Value& event) {
  const std::string kind = printable_at(event, "kind");
  const std::string subject = printable_at(event, "subject");
  const std::string message = printable_at(event, "message");
  const std::string separator = subject.empty() || message.empty() ? "" : ": ";
  return fmt::format("{:>5} {} {} {}{}{}", number_at(event, "number"),
                     coloured(Colour::Dim, printable_at(event, "time")),
                     coloured(colour_of(kind), fmt::format("{:<20}", kind)), subject, separator, message);
}

}  // namespace segue::cli

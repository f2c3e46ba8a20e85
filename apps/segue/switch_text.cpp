// SPDX-License-Identifier: Apache-2.0
#include "switch_text.hpp"

#include <fmt/core.h>

#include "output.hpp"
#include "transition_text.hpp"

namespace segue::cli {

namespace {

using type::Value;

std::string name_or_empty(const std::string& name) {
  return name.empty() ? std::string("(empty)") : name;
}

std::string actions_text(const Value& result) {
  Table table({{"STARTED", Table::Align::Right}, {"TOOK", Table::Align::Right}, {"ACTION"}, {"OUTCOME"}});
  for (const Value& action : list_at(result, "actions")) {
    const std::string outcome = text_at(action, "outcome");
    const std::string error = text_at(action, "error");
    const Colour colour = outcome == "done" ? Colour::Green : outcome == "failed" ? Colour::Red : Colour::Dim;
    table.add({format_seconds(number_at(action, "started_s")),
               format_seconds(number_at(action, "duration_s")), action_label(action),
               coloured(colour, outcome) + (error.empty() ? "" : ": " + error)});
  }
  return list_at(result, "actions").empty() ? std::string() : table.text();
}

void print_reasons(const Value& result) {
  for (const Value& item : list_at(result, "diagnostics")) {
    fmt::print(stderr, "{}:{}:{}: {}: {}\n", text_at(item, "file"), number_at(item, "line"),
               number_at(item, "column"), text_at(item, "severity"), text_at(item, "message"));
  }
  const std::string error = text_at(result, "error");
  if (!error.empty()) fmt::print(stderr, "segue: error: {}\n", error);
  const std::string leftover = text_at(result, "leftover");
  if (!leftover.empty()) fmt::print(stderr, "segue: warning: {}\n", leftover);
}

}  // namespace

std::string outcome_line(const Value& result) {
  int done = 0;
  for (const Value& action : list_at(result, "actions"))
    done += text_at(action, "outcome") == "done" ? 1 : 0;
  const std::string cause = text_at(result, "cause");
  const std::string why = cause.empty() || cause == "request" ? "" : " (" + cause + ")";
  const std::string line = fmt::format("{} -> {}{}: {}", name_or_empty(text_at(result, "from")),
                                       name_or_empty(text_at(result, "to")), why, text_at(result, "outcome"));
  if (list_at(result, "actions").empty()) return line;
  const std::string leftover = text_at(result, "leftover").empty() ? "" : ", retire incomplete";
  return line + fmt::format(", {} action{} in {} (commit {}){}", done, done == 1 ? "" : "s",
                            format_seconds(number_at(result, "duration_s")),
                            format_seconds(number_at(result, "commit_s")), leftover);
}

int show_outcome(const Value& result, const Context& context) {
  const bool done = text_at(result, "outcome") == "done";
  if (context.json()) {
    print_json(result);
  } else {
    print(actions_text(result));
    print_line(coloured(done ? Colour::Green : Colour::Red, outcome_line(result)));
  }
  print_reasons(result);
  return done ? kDone : kFailed;
}

}  // namespace segue::cli

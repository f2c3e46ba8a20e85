// SPDX-License-Identifier: Apache-2.0
#include "transition_text.hpp"

#include <segue/model/files.hpp>

#include <fmt/core.h>

#include "output.hpp"

namespace segue::cli {

namespace {

using type::Value;

std::string name_or_empty(const std::string& name) {
  return name.empty() ? std::string("(empty)") : name;
}

std::string phase_text(const Value& transition, std::string_view phase) {
  std::string text;
  std::size_t count = 0;
  for (const Value& action : list_at(transition, "actions")) {
    if (text_at(action, "phase") != phase) continue;
    ++count;
    text += fmt::format("{:>5}  {:<14} {}\n", number_at(action, "id"), text_at(action, "kind"),
                        action_label(action).substr(text_at(action, "kind").size() + 1));
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

}  // namespace

std::string action_label(const Value& action) {
  const std::string kind = text_at(action, "kind");
  const std::string task = text_at(action, "task");
  if (kind == "connect" || kind == "disconnect") {
    const std::string policy = text_at(action, "policy");
    const std::string suffix = policy.empty() || policy == "data" ? "" : " (" + policy + ")";
    return fmt::format("{} {} -> {}{}", kind, text_at(action, "from"), text_at(action, "to"), suffix);
  }
  if (kind == "hand_over")
    return fmt::format("{} {} -> {}", kind, text_at(action, "from"), text_at(action, "to"));
  if (kind == "deploy" || kind == "undeploy") {
    return fmt::format("{} {}/{}", kind, text_at(action, "host"), text_at(action, "process"));
  }
  if (kind == "call_operation") return fmt::format("{} {}.{}", kind, task, text_at(action, "operation"));
  return fmt::format("{} {}", kind, task);
}

std::string describe_transition(const Value& transition) {
  static const Value none;
  const Value* counts = transition.find("counts");
  const Value& counted = counts != nullptr ? *counts : none;
  const double total = number_at(counted, "total");
  std::string text = fmt::format("{} -> {}: ", name_or_empty(text_at(transition, "from")),
                                 name_or_empty(text_at(transition, "to")));
  if (total == 0) return text + "nothing to do\n";
  text += fmt::format("{} action{}, {} of them state changes; order {}\n", total, total == 1 ? "" : "s",
                      number_at(counted, "state_changes"), text_at(transition, "order"));
  for (const auto phase : model::kPhaseNames)
    text += phase_text(transition, phase);
  return text + "total: " + counts_text(counted) + '\n';
}

std::string describe(const model::Transition& transition) {
  return describe_transition(model::to_value(transition));
}

}  // namespace segue::cli

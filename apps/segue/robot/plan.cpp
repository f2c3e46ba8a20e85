// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>

#include <fmt/core.h>

#include <memory>

#include "../connection.hpp"
#include "../report_text.hpp"

namespace segue::cli {

namespace {

using type::Value;

struct PlanOptions {
  std::string controller;
  std::string order;
  bool force = false;
  bool exit_code = false;
  bool take_over = false;
  Duration timeout = std::chrono::seconds(60);
};

bool is_set(const Value& map, std::string_view key) {
  const Value* value = map.find(key);
  return value != nullptr && value->is_bool() && value->as_bool();
}

/// "explore: changed (controllers/explore.yaml, 3f2a9c81d0b2 -> 8812aa09bb11), runs", and its edits.
std::string change_text(const Value& change) {
  const std::string kind = printable_at(change, "change");
  const std::string from = printable_at(change, "from_version");
  const std::string to = printable_at(change, "to_version");
  const std::string arrow = from.empty() || to.empty() ? "" : " -> ";
  std::string text = fmt::format("{}: {} ({}, {}{}{})", printable_at(change, "controller"), kind,
                                 printable_at(change, "file"), from, arrow, to);
  if (is_set(change, "runs"))
    text += kind == "removed" ? "; it keeps running until the next switch" : ", it runs";
  text += '\n';
  const auto& edits = list_at(change, "edits");
  for (const Value& edit : edits) {
    if (edit.is_string()) text += "    " + edit.as_string() + '\n';
  }
  if (kind == "changed" && edits.empty()) text += "    the network is the same\n";
  return text;
}

std::string changes_text(const Value& answer) {
  std::string text;
  for (const Value& change : list_at(answer, "changes"))
    text += change_text(change);
  return text.empty() ? "no controller has changed\n" : text;
}

/// Whether `apply` would change anything: a controller, or what runs.
bool has_changes(const Value& answer) {
  const Value* transition = answer.find("transition");
  return !list_at(answer, "changes").empty() ||
         (transition != nullptr && !list_at(*transition, "actions").empty());
}

int show_plan(const Value& answer, const PlanOptions& options, const Context& context) {
  const Value* transition = answer.find("transition");
  const bool refused = printable_at(answer, "outcome") == "refused";
  if (context.json()) {
    print_json(answer);
  } else if (!refused) {
    print(changes_text(answer));
    if (transition != nullptr) print(describe_transition(*transition));
  }
  print_reasons(answer);
  if (refused) return kFailed;
  return options.exit_code && has_changes(answer) ? kChanges : kDone;
}

Result<control::RequestOptions> options_of(const PlanOptions& options, std::string_view verb) {
  const auto order = model::order_named(options.order);
  if (!order) return order.error();
  return control::RequestOptions{
      .order = *order, .force = options.force, .who = sender(verb), .take_over = options.take_over};
}

int plan(control::RobotService& robot, const PlanOptions& options, const Context& context) {
  const auto asked = options_of(options, "plan");
  if (!asked) return failed(context, asked.error());
  const auto answer = robot.plan(options.controller, *asked, deadline_in(options.timeout));
  return answer ? show_plan(*answer, options, context) : failed(context, answer.error());
}

int show_applied(const Value& answer, const Context& context) {
  const std::string outcome = printable_at(answer, "outcome");
  const Value* transition = answer.find("transition");
  if (context.json()) {
    print_json(answer);
  } else {
    print(changes_text(answer));
    if (transition != nullptr) print(outcome_text(*transition));
    print_line(outcome == "done" ? "applied" : outcome + ": controllers unchanged");
  }
  print_reasons(answer);
  return outcome == "done" ? kDone : kFailed;
}

int apply(control::RobotService& robot, const PlanOptions& options, const Context& context) {
  const auto asked = options_of(options, "apply");
  if (!asked) return failed(context, asked.error());
  const auto answer = robot.apply(*asked, deadline_in(options.timeout));
  return answer ? show_applied(*answer, context) : failed(context, answer.error());
}

void add_options(Verb& verb, PlanOptions& options, Context& context) {
  verb.flag("--force", options.force,
            "kill the processes to be removed instead of stopping their tasks; for tasks that hang");
  add_order_option(verb, options.order);
  verb.option("--timeout DURATION", options.timeout, "how long to wait for the outcome (default 60s)");
  add_robot_option(verb, context);
}

}  // namespace

void add_plan(Verb& app, Context& context) {
  const auto options = std::make_shared<PlanOptions>();
  Verb& verb = add_verb(
      app, context, "plan", "show what `segue apply` would change in a running robot",
      "  segue plan\n  segue plan explore --exit-code > /dev/null || echo something has changed\n\n"
      "Compares the robot's files as they are now with those that the runtime loaded, and shows the\n"
      "transition from what runs now to the running controller's new version, or to CONTROLLER as its file\n"
      "is now. Nothing is changed.",
      [options, &context] {
        return with_robot(context,
                          [&](control::RobotService& robot) { return plan(robot, *options, context); });
      });
  verb.option("CONTROLLER", options->controller, "show the transition to this controller instead");
  verb.flag("--exit-code", options->exit_code, "end with status 4 where `apply` would change something");
  add_options(verb, *options, context);
}

void add_apply(Verb& app, Context& context) {
  const auto options = std::make_shared<PlanOptions>();
  Verb& verb = add_verb(
      app, context, "apply", "take a running robot's files as they are now",
      "  segue plan && segue apply\n\n"
      "All files of the robot are read and checked first: if one has errors, nothing changes. Then the\n"
      "running controller goes to its new version by a transition, as `segue plan` shows it. If that\n"
      "fails, it is undone and the controllers are unchanged. A controller that runs and whose file\n"
      "is gone keeps running until the next switch.",
      [options, &context] {
        return with_robot(context,
                          [&](control::RobotService& robot) { return apply(robot, *options, context); });
      });
  verb.flag("--take-over", options->take_over,
            "also where somebody else, such as a mission, commands the robot; ends what that does");
  add_options(verb, *options, context);
}

}  // namespace segue::cli

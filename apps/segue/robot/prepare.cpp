// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <memory>
#include <string>
#include <vector>

#include "../connection.hpp"

namespace segue::cli {

namespace {

using type::Value;

struct PrepareOptions {
  std::vector<std::string> controllers;
  Duration timeout = std::chrono::seconds(60);
};

bool is_ready(const Value& entry) {
  const Value* ready = entry.find("ready");
  return ready != nullptr && ready->is_bool() && ready->as_bool();
}

std::string readiness_line(const Value& entry) {
  const std::string name = printable_at(entry, "controller");
  const auto prepared = number_at(entry, "prepared");
  if (!is_ready(entry) && prepared == 0)
    return fmt::format("{} is not ready: {}", name, printable_at(entry, "reason"));
  const std::string reason = is_ready(entry) ? "" : "; " + printable_at(entry, "reason");
  return fmt::format("{}: {} of {} tasks are ready{}", name, prepared, number_at(entry, "tasks"), reason);
}

int prepare_controllers(control::RobotService& robot, const PrepareOptions& options, const Context& context) {
  const auto answer = robot.prepare(options.controllers, 0, deadline_in(options.timeout));
  if (!answer) return failed(context, answer.error());
  int status = kDone;
  for (const Value& entry : answer->is_list() ? answer->as_list() : Value::List{}) {
    if (!is_ready(entry)) status = kFailed;
    if (!context.json()) print_line(readiness_line(entry));
  }
  if (context.json()) {
    print_json(*answer);
  } else if (options.controllers.empty()) {
    print_line("no controller is prepared");
  }
  return status;
}

}  // namespace

void add_prepare(Verb& app, Context& context) {
  const auto options = std::make_shared<PrepareOptions>();
  Verb& verb = add_verb(
      app, context, "prepare", "keep controllers of a running robot prepared, for fast switches",
      "  segue prepare dock explore    # the likeliest first\n  segue prepare                 # release "
      "all\n\n"
      "Their processes run and their tasks are configured, as far as the running controller and the budget "
      "in\n"
      "the robot file (`look_ahead`) permit. They stay ready across switches.",
      [options, &context] {
        return with_robot(context, [&](control::RobotService& robot) {
          return prepare_controllers(robot, *options, context);
        });
      });
  verb.option("NAME", options->controllers, "the controllers, likeliest first");
  verb.option("--timeout DURATION", options->timeout,
              "how long to wait until they are prepared (default 60s)");
  add_robot_option(verb, context);
}

}  // namespace segue::cli

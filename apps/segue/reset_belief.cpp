// SPDX-License-Identifier: Apache-2.0
#include "connection.hpp"

namespace segue::cli {

namespace {

int reset_belief(control::RobotService& robot, const Context& context) {
  const auto done = robot.reset_belief();
  if (!done) return failed(context, done.error());
  if (context.json()) {
    print_json(type::Value::map({{"outcome", "done"}}));
  } else {
    print_line("the observed state is now the expected one; `segue status` shows it");
  }
  return kDone;
}

}  // namespace

void add_reset_belief(Verb& app, Context& context) {
  Verb& verb = add_verb(
      app, context, "reset-belief", "accept the observed state as expected, after tasks were changed by hand",
      "  segue reset-belief && segue status", [&context] {
        return with_robot(context,
                          [&](control::RobotService& robot) { return reset_belief(robot, context); });
      });
  add_robot_option(verb, context);
}

}  // namespace segue::cli

// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>

#include "connection.hpp"
#include "switch_text.hpp"

namespace segue::cli {

namespace {

int history(control::RobotService& robot, const Context& context) {
  const auto found = robot.history();
  if (!found) return failed(context, found.error());
  if (context.json()) {
    print_json(*found);
    return kDone;
  }
  if (!found->is_list() || found->as_list().empty()) {
    print_line("nothing was requested yet; try `segue switch NAME`");
    return kDone;
  }
  for (const type::Value& result : found->as_list())
    print_line(outcome_line(result));
  return kDone;
}

}  // namespace

void add_history(CLI::App& app, Context& context) {
  CLI::App* verb = add_verb(
      app, context, "history", "what was requested, and how long it took", "  segue history", [&context] {
        return with_robot(context, [&](control::RobotService& robot) { return history(robot, context); });
      });
  add_robot_option(*verb, context);
}

}  // namespace segue::cli

// SPDX-License-Identifier: Apache-2.0
#include <segue/base/input_file.hpp>

#include <memory>

#include "../connection.hpp"

namespace segue::cli {

namespace {

/// `file`: of the network that is expected from now on; empty: what is observed.
int reset_belief(control::RobotService& robot, const std::string& file, const Context& context) {
  const auto text = file.empty() ? Result<std::string>(std::string()) : network_text(file);
  if (!text) return failed(context, text.error());
  const auto done = robot.reset_belief(*text, file);
  if (!done) return failed(context, done.error());
  if (context.json()) {
    print_json(type::Value::map({{"outcome", "done"}}));
  } else if (file.empty()) {
    print_line("the observed state is now the expected one; `segue status` shows it");
  } else {
    print_line("the network of '" + file + "' is now the expected state; `segue status` shows what differs");
  }
  return kDone;
}

}  // namespace

void add_reset_belief(Verb& app, Context& context) {
  const auto file = std::make_shared<std::string>();
  Verb& verb = add_verb(
      app, context, "reset-belief", "accept the observed state as expected, after tasks were changed by hand",
      "  segue reset-belief && segue status\n"
      "  segue reset-belief --network explore.yaml   # what runs is to be this network, whatever is observed",
      [file, &context] {
        return with_robot(context,
                          [&](control::RobotService& robot) { return reset_belief(robot, *file, context); });
      });
  verb.option("--network FILE", *file, "expect the network of this file instead of the observed one");
  add_robot_option(verb, context);
}

}  // namespace segue::cli

// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <memory>

#include "../connection.hpp"
#include "../report_text.hpp"

namespace segue::cli {

namespace {

struct RepairOptions {
  bool force = false;
  bool take_over = false;
  Duration timeout = std::chrono::seconds(60);
};

int repair_robot(control::RobotService& robot, const RepairOptions& options, const Context& context) {
  const control::RequestOptions asked{
      .force = options.force, .who = sender("repair"), .take_over = options.take_over};
  const auto answer = robot.repair(asked, deadline_in(options.timeout));
  return answer ? show_outcome(*answer, context) : failed(context, answer.error());
}

}  // namespace

void add_repair(Verb& app, Context& context) {
  const auto options = std::make_shared<RepairOptions>();
  Verb& verb = add_verb(
      app, context, "repair", "repair what is missing or faulty in what a robot runs",
      "  segue status    # says what is missing, and what repairs it\n  segue repair\n\n"
      "It requests what runs once more, so that tasks, processes and connections that the robot needs are\n"
      "made anew where they are missing or faulty, also what the runtime has given up. Pools begin again, "
      "too.",
      [options, &context] {
        return with_robot(
            context, [&](control::RobotService& robot) { return repair_robot(robot, *options, context); });
      });
  verb.flag("--force", options->force,
            "kill the processes to be replaced instead of stopping their tasks; for tasks that hang");
  verb.flag("--take-over", options->take_over,
            "also where somebody else, such as a mission, commands the robot; ends what that does");
  verb.option("--timeout DURATION", options->timeout, "how long to wait for the outcome (default 60s)");
  add_robot_option(verb, context);
}

}  // namespace segue::cli

// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>

#include <fmt/core.h>

#include <memory>

#include "../connection.hpp"
#include "health_text.hpp"
#include "status_text.hpp"
#include "task_table.hpp"

namespace segue::cli {

namespace {

using type::Value;

/// How many tasks belong to pools of processes: no network names them.
std::int64_t tasks_of_pools(const Value& status) {
  std::int64_t count = 0;
  for (const Value& pool : list_at(status, "pools")) {
    for (const Value& one : list_at(pool, "instances"))
      count += number_at(one, "pid") == 0 ? 0 : 1;
  }
  return count;
}

std::string status_heading(const Value& status) {
  const std::string controller = printable_at(status, "controller");
  const auto tasks = static_cast<std::int64_t>(list_at(status, "tasks").size());
  return fmt::format("robot {} (pid {}, up {}): {}, {}\n",
                     coloured(Colour::Bold, printable_at(status, "robot")), number_at(status, "pid"),
                     format_seconds(number_at(status, "uptime_s")),
                     !controller.empty()               ? "controller " + coloured(Colour::Green, controller)
                     : tasks == tasks_of_pools(status) ? "the empty network"
                                                       : "an unnamed network",
                     state_text(status));
}

int exit_status(const Value& status, bool by_health) {
  const std::string health = health_state(status);
  return by_health && (health == "in_trouble" || health == "lost") ? kTrouble : kDone;
}

int show_status(control::RobotService& robot, bool by_health, const Context& context) {
  const auto status = robot.status();
  if (!status) {
    const int failure = failed(context, status.error());
    return by_health ? static_cast<int>(kUnreachable) : failure;
  }
  if (context.json()) {
    print_json(*status);
    return exit_status(*status, by_health);
  }
  print(status_heading(*status) + state_lines(*status));
  if (!list_at(*status, "tasks").empty()) print('\n' + task_table(*status, false));
  const auto& connections = list_at(*status, "connections");
  if (!connections.empty()) print('\n' + connections_table(connections));
  print(faults_text(*status));
  return exit_status(*status, by_health);
}

}  // namespace

void add_status(Verb& app, Context& context) {
  const auto by_health = std::make_shared<bool>(false);
  Verb& verb = add_verb(
      app, context, "status", "show the state of a running robot",
      "  segue status\n  segue status --format json\n  segue status --exit-code || segue repair",
      [by_health, &context] {
        return with_robot(
            context, [&](control::RobotService& robot) { return show_status(robot, *by_health, context); });
      });
  verb.flag("--exit-code", *by_health,
            "exit status 5 if a task, process, host or connection that the robot needs is missing, faulty or "
            "given up, or a pool is short; 0 during a transition; 3 if the robot cannot be reached");
  add_robot_option(verb, context);
}

}  // namespace segue::cli

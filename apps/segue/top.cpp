// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <memory>

#include "connection.hpp"
#include "health_text.hpp"
#include "task_table.hpp"

namespace segue::cli {

namespace {

using type::Value;

struct TopOptions {
  bool once = false;
  Duration interval = std::chrono::seconds(1);
};

std::string top_page(const Value& status) {
  const std::string controller = printable_at(status, "controller");
  return fmt::format("{}: {}, {}; up {}; {} tasks, {} connections\n\n{}",
                     coloured(Colour::Bold, printable_at(status, "robot")),
                     controller.empty() ? "the empty network" : controller, state_text(status),
                     format_seconds(number_at(status, "uptime_s")), list_at(status, "tasks").size(),
                     list_at(status, "connections").size(), task_table(status, true));
}

/// If the status of a runtime has no processor times, they are taken from the report of each task.
void add_processor_times(control::RobotService& robot, Value& status) {
  Value* tasks = status.is_map() ? status.as_map().find("tasks") : nullptr;
  if (tasks == nullptr || !tasks->is_list()) return;
  for (Value& task : tasks->as_list()) {
    if (task.find("cpu_us") != nullptr) continue;
    const auto report = robot.task(printable_at(task, "id"));  // may have been removed since
    const Value* timing = report ? report->find("timing") : nullptr;
    if (timing != nullptr && task.is_map()) task.as_map().set("cpu_us", number_at(*timing, "cpu_us"));
  }
}

int show_top(control::RobotService& robot, const TopOptions& options, const Context& context) {
  const bool once = options.once || context.json() || !output_is_terminal();
  for (;;) {
    auto status = robot.status();
    if (!status) return failed(context, status.error());
    add_processor_times(robot, *status);
    if (context.json()) {
      print_json(*status);
    } else {
      print((once ? std::string() : std::string(kClearScreen)) + top_page(*status));
    }
    if (once) return kDone;
    print_line(coloured(Colour::Dim, "Ctrl-C exits"));
    if (reader_leaves_within(options.interval)) return kDone;
  }
}

}  // namespace

void add_top(Verb& app, Context& context) {
  const auto options = std::make_shared<TopOptions>();
  Verb& verb = add_verb(app, context, "top", "show the timing of all tasks continuously",
                        "  segue top\n  segue top --once", [options, &context] {
                          return with_robot(context, [&](control::RobotService& robot) {
                            return show_top(robot, *options, context);
                          });
                        });
  verb.flag("--once", options->once, "print once and exit; the default if the output is not a terminal");
  verb.option("--interval DURATION", options->interval, "time between refreshes (default 1s)")
      .between(std::chrono::milliseconds(10), std::chrono::hours(24));
  add_robot_option(verb, context);
}

}  // namespace segue::cli

// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>

#include <fmt/core.h>

#include <algorithm>
#include <memory>

#include "../connection.hpp"

namespace segue::cli {

namespace {

using type::Value;

/// Whether `name` is the port "task.port", or its task.
bool is_of(const std::string& port, const std::string& name) {
  return port == name || (port.starts_with(name) && port[name.size()] == '.' &&
                          port.find('.', name.size() + 1) == std::string::npos);
}

std::string text_of(const Value::List& connections) {
  constexpr auto kRight = Table::Align::Right;
  Table table({{"FROM"},
               {"TO"},
               {"MEAN", kRight},
               {"99 % WITHIN", kRight},
               {"WORST", kRight},
               {"READ", kRight},
               {"LOST", kRight}});
  for (const Value& connection : connections) {
    const auto micros = [&](std::string_view key) {
      return number_at(connection, "measured") > 0 ? format_seconds(number_at(connection, key) * 1e-6)
                                                   : std::string("-");
    };
    table.add({printable_at(connection, "from"), printable_at(connection, "to"), micros("latency_us"),
               micros("latency_p99_us"), micros("latency_worst_us"),
               fmt::format("{}", number_at(connection, "read")),
               fmt::format("{}", number_at(connection, "dropped"))});
  }
  return table.text();
}

int show_delays(control::RobotService& robot, const std::string& name, const Context& context) {
  const auto status = robot.status();
  if (!status) return failed(context, status.error());
  Value::List found;
  std::vector<std::string> names = task_names(*status);
  for (const Value& connection : list_at(*status, "connections")) {
    const std::string from = printable_at(connection, "from");
    const std::string to = printable_at(connection, "to");
    if (is_of(from, name) || is_of(to, name)) found.push_back(connection);
    names.insert(names.end(), {from, to});
  }
  if (found.empty()) {
    const bool is_task = std::ranges::find(names, name) != names.end();
    return failed(context,
                  fail(ErrorCode::NotFound,
                       is_task ? "the task has no connections"
                               : "nothing that is connected has this name" + did_you_mean(name, names),
                       name));
  }
  if (context.json()) {
    print_json(Value(std::move(found)));
  } else {
    print(text_of(found));
  }
  return kDone;
}

}  // namespace

void add_delay(Verb& app, Context& context) {
  const auto name = std::make_shared<std::string>();
  Verb& verb = add_verb(app, context, "delay", "how long samples take from their write until they are read",
                        "  segue delay laser.scan          # to each of its readers\n"
                        "  segue delay drive               # all connections of a task",
                        [name, &context] {
                          return with_robot(context, [&](control::RobotService& robot) {
                            return show_delays(robot, *name, context);
                          });
                        });
  verb.option("TASK.PORT", *name, "an output or input port, or a task: all of its ports").required();
  add_robot_option(verb, context);
}

}  // namespace segue::cli

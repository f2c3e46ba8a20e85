// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/type/yaml.hpp>

#include <fmt/core.h>

#include <memory>

#include "../connection.hpp"

namespace segue::cli {

namespace {

using type::Value;

struct SetOptions {
  std::string assignment;
  bool beside = false;
  Duration timeout = std::chrono::seconds(10);
};

/// The current value, for the report.
std::string present_value(control::RobotService& robot, const Address& address) {
  const auto task = robot.task(address.task);
  const Value* value = task ? task->find("properties") : nullptr;
  std::string_view path = address.member;
  while (value != nullptr && !path.empty()) {
    const auto dot = path.find('.');
    value = value->find(path.substr(0, dot));
    path = dot == std::string_view::npos ? std::string_view() : path.substr(dot + 1);
  }
  return value == nullptr ? std::string() : type::describe(*value);
}

/// A property that is not live gets another value where a switch configures the task anew.
void suggest_variant(control::RobotService& robot, const SetOptions& options) {
  const auto status = robot.status();
  if (!status || printable_at(*status, "controller").empty()) return;
  print_note(fmt::format("a switch configures the task anew: `segue switch {} --set {}`",
                         printable_at(*status, "controller"), options.assignment));
}

int set_property(control::RobotService& robot, const SetOptions& options, const Context& context) {
  const auto equals = options.assignment.find('=');
  const auto value = type::parse_yaml(options.assignment.substr(equals + 1), "the value");
  if (!value) return failed(context, value.error());
  const auto address = resolve(robot, options.assignment.substr(0, equals), "PROPERTY");
  if (!address) return failed(context, address.error());
  const std::string before = present_value(robot, *address);
  const auto done = robot.set_property(address->task, address->member, *value,
                                       sender_of("set", options.beside), deadline_in(options.timeout));
  if (!done) {
    const int status = failed(context, done.error());
    if (done.error().code == ErrorCode::InvalidState && !context.json()) suggest_variant(robot, options);
    return status;
  }
  if (context.json()) {
    print_json(Value::map({{"task", address->task}, {"property", address->member}, {"value", *value}}));
  } else {
    print_line(fmt::format("{}.{} = {}{}", address->task, address->member, type::describe(*value),
                           before.empty() ? "" : " (was " + before + ")"));
  }
  return kDone;
}

}  // namespace

void add_set(Verb& app, Context& context) {
  const auto options = std::make_shared<SetOptions>();
  Verb& verb = add_verb(
      app, context, "set", "set a property of a task",
      "  segue set drive.max_speed=0.4\n  segue set 'seeker.goal={x: 1.0, y: 2.0}'", [options, &context] {
        return with_robot(
            context, [&](control::RobotService& robot) { return set_property(robot, *options, context); });
      });
  verb.option("ASSIGNMENT TASK.PROPERTY=VALUE", options->assignment,
              "the property (a.b for a field of it) and its value as YAML")
      .required()
      .check([](const std::string& text) {
        return text.find('=') == std::string::npos ? "write TASK.PROPERTY=VALUE" : std::string();
      });
  add_beside_option(verb, options->beside);
  verb.option("--timeout DURATION", options->timeout, "how long to wait for the task (default 10s)");
  add_robot_option(verb, context);
}

}  // namespace segue::cli

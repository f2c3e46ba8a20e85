// SPDX-License-Identifier: Apache-2.0
#include <segue/type/yaml.hpp>

#include <fmt/core.h>

#include <memory>

#include "../connection.hpp"

namespace segue::cli {

namespace {

using type::Value;

struct WriteOptions {
  std::string assignment;
  bool beside = false;
  Duration timeout = std::chrono::seconds(10);
};

int write_sample(control::RobotService& robot, const WriteOptions& options, const Context& context) {
  const auto equals = options.assignment.find('=');
  const auto value = type::parse_yaml(options.assignment.substr(equals + 1), "the sample");
  if (!value) return failed(context, value.error());
  const auto address = resolve(robot, options.assignment.substr(0, equals), "PORT");
  if (!address) return failed(context, address.error());
  const auto done = robot.write(address->task, address->member, *value, sender_of("write", options.beside),
                                deadline_in(options.timeout));
  if (!done) return failed(context, done.error());
  if (context.json()) {
    print_json(Value::map({{"task", address->task}, {"port", address->member}, {"value", *value}}));
  } else {
    print_line(fmt::format("{} has read {} from {}", address->task, type::describe(*value), address->member));
  }
  return kDone;
}

}  // namespace

void add_write(Verb& app, Context& context) {
  const auto options = std::make_shared<WriteOptions>();
  Verb& verb = add_verb(app, context, "write", "write a sample to an input port of a task",
                        "  segue write 'drive.command={forward: 0.2, turn: 0.0}'\n\n"
                        "The sample comes beside those of the port's connections, and is the port's last one "
                        "until another comes.",
                        [options, &context] {
                          return with_robot(context, [&](control::RobotService& robot) {
                            return write_sample(robot, *options, context);
                          });
                        });
  verb.option("ASSIGNMENT TASK.PORT=VALUE", options->assignment, "the input port and the sample as YAML")
      .required()
      .check([](const std::string& text) {
        return text.find('=') == std::string::npos ? "write TASK.PORT=VALUE" : std::string();
      });
  add_beside_option(verb, options->beside);
  verb.option("--timeout DURATION", options->timeout,
              "how long to wait until the task has read it (default 10s)");
  add_robot_option(verb, context);
}

}  // namespace segue::cli

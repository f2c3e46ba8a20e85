// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/type/yaml.hpp>

#include <fmt/core.h>

#include <algorithm>
#include <memory>

#include "../connection.hpp"

namespace segue::cli {

namespace {

using type::Value;
using type::ValueMap;

struct CallOptions {
  std::string operation;
  std::vector<std::string> arguments;
  bool beside = false;
  Duration timeout = std::chrono::seconds(10);
};

/// "name=value": a plain name before the first '='.
bool is_named(const std::string& text) {
  const auto equals = text.find('=');
  return equals != std::string::npos && is_identifier(text.substr(0, equals));
}

Result<Value> named_arguments(const std::vector<std::string>& arguments) {
  ValueMap map;
  for (const std::string& argument : arguments) {
    const auto equals = argument.find('=');
    auto value = type::parse_yaml(argument.substr(equals + 1), "argument " + quote(argument));
    if (!value) return value;
    map.set(argument.substr(0, equals), std::move(*value));
  }
  return Value(std::move(map));
}

/// name=value pairs, one map or list in YAML, or values in the declared order of the operation's arguments.
Result<Value> arguments_of(const std::vector<std::string>& arguments) {
  if (!arguments.empty() && std::all_of(arguments.begin(), arguments.end(), is_named))
    return named_arguments(arguments);
  Value::List list;
  for (const std::string& argument : arguments) {
    auto value = type::parse_yaml(argument, "argument " + quote(argument));
    if (!value) return value;
    list.push_back(std::move(*value));
  }
  return Value(std::move(list));
}

/// Names the limit where it was too short.
Error explained(const Error& error, const CallOptions& options) {
  if (error.code != ErrorCode::DeadlineExceeded) return error;
  return fail(error.code, fmt::format("{} has not answered within {}, see --timeout", options.operation,
                                      format_duration(options.timeout)))
      .because_of(error);
}

int call_operation(control::RobotService& robot, const CallOptions& options, const Context& context) {
  const auto arguments = arguments_of(options.arguments);
  if (!arguments) return failed(context, arguments.error());
  const auto address = resolve(robot, options.operation, "OPERATION");
  if (!address) return failed(context, address.error());
  const auto result = robot.call(address->task, address->member, *arguments,
                                 sender_of("call", options.beside), deadline_in(options.timeout));
  if (!result) return failed(context, explained(result.error(), options));
  if (context.json()) {
    print_json(*result);
  } else if (result->is_null()) {
    print_line("done");
  } else {
    print_line(readable(*result));
  }
  return kDone;
}

}  // namespace

void add_call(Verb& app, Context& context) {
  const auto options = std::make_shared<CallOptions>();
  Verb& verb = add_verb(app, context, "call", "call an operation of a task",
                        "  segue call odometry.reset\n  segue call joystick.push forward=0.5 turn=0\n"
                        "  segue call seeker.set_goal '{x: 1.0, y: 2.0}'",
                        [options, &context] {
                          return with_robot(context, [&](control::RobotService& robot) {
                            return call_operation(robot, *options, context);
                          });
                        });
  verb.option("TASK.OPERATION", options->operation, "the operation").required();
  verb.option("ARGUMENT", options->arguments, "arguments as name=value, or values in declared order (YAML)");
  add_beside_option(verb, options->beside);
  verb.option("--timeout DURATION", options->timeout, "how long to wait for the result (default 10s)");
  add_robot_option(verb, context);
}

}  // namespace segue::cli

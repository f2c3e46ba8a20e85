// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>

#include <fmt/core.h>

#include <memory>

#include "../connection.hpp"
#include "../rest.hpp"

namespace segue::cli {

namespace {

using type::Value;

struct StopOptions {
  bool release = false;
  Duration timeout = std::chrono::seconds(30);
};

int release_robot(control::RobotService& robot, const Context& context) {
  if (auto released = robot.release_stop(sender("stop --release")); !released)
    return failed(context, released.error());
  if (context.json()) {
    print_json(Value::map({{"released", true}}));
  } else {
    print_line("released: the robot can be commanded again");
  }
  return kDone;
}

int stop_robot(control::RobotService& robot, const StopOptions& options, const Context& context) {
  if (options.release) return release_robot(robot, context);
  const auto rest = robot.stop(sender("stop"), deadline_in(options.timeout));
  if (!rest) return failed(context, rest.error());
  if (context.json()) {
    print_json(*rest);
  } else {
    print_line(rest_text("stopped", *rest));
    print_note("whatever is requested is refused until `segue stop --release`");
  }
  return is_at_rest(*rest) ? kDone : kFailed;
}

}  // namespace

void add_stop(Verb& app, Context& context) {
  const auto options = std::make_shared<StopOptions>();
  Verb& verb = add_verb(
      app, context, "stop", "bring a robot to rest at once, whoever commands it",
      "  segue stop\n  segue stop --release\n\n"
      "The robot goes to the controller that 'halt' of its robot file names; where it has none, "
      "or is not\nat rest in time, the tasks that hold devices are stopped, and the exit status "
      "is 1 if it should have\nbeen. A mission that commands the robot ends. Until --release, "
      "whatever is requested is refused.",
      [options, &context] {
        return with_robot(context,
                          [&](control::RobotService& robot) { return stop_robot(robot, *options, context); });
      });
  verb.flag("--release", options->release, "let the robot be commanded again; it stays as it is");
  verb.option("--timeout DURATION", options->timeout, "how long to wait until it is at rest (default 30s)");
  add_robot_option(verb, context);
}

}  // namespace segue::cli

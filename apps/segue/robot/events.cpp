// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <memory>

#include "../connection.hpp"
#include "../report_text.hpp"

namespace segue::cli {

namespace {

using type::Value;

constexpr Duration kFollowWait = std::chrono::seconds(1);

struct EventsOptions {
  bool follow = false;
  std::uint64_t after = 0;
};

int list_events(control::RobotService& robot, const EventsOptions& options, const Context& context) {
  std::uint64_t last = options.after;
  for (;;) {
    const auto found = robot.events(last, options.follow ? kFollowWait : Duration(0));
    if (!found) return failed(context, found.error());
    if (context.json() && !options.follow) {
      print_json(*found);
      return kDone;
    }
    if (!found->is_list())
      return failed(context, fail(ErrorCode::Internal, "the robot sent events that are not a list"));
    for (const Value& event : found->as_list()) {
      last = static_cast<std::uint64_t>(number_at(event, "number"));
      context.json() ? print_json_line(event) : print_line(event_line(event));
    }
    if (!options.follow || reader_leaves_within(Duration(0))) return kDone;
  }
}

}  // namespace

void add_events(Verb& app, Context& context) {
  const auto options = std::make_shared<EventsOptions>();
  Verb& verb = add_verb(app, context, "events", "list past events, and with --follow new ones",
                        "  segue events\n  segue events --follow", [options, &context] {
                          return with_robot(context, [&](control::RobotService& robot) {
                            return list_events(robot, *options, context);
                          });
                        });
  verb.flag("-f,--follow", options->follow, "follow new events until Ctrl-C");
  verb.option("--after NUMBER", options->after, "only events with a greater number");
  add_robot_option(verb, context);
}

}  // namespace segue::cli

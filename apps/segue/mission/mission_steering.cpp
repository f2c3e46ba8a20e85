// SPDX-License-Identifier: Apache-2.0
#include "mission_steering.hpp"

#include <segue/base/text.hpp>

#include <fmt/core.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "../connection.hpp"
#include "../output.hpp"
#include "../rest.hpp"

namespace segue::cli {

namespace {

using type::Value;

/// How often it is looked whether a mission has followed.
constexpr Duration kPollPeriod = std::chrono::milliseconds(50);

struct SteeringOptions {
  Duration timeout = std::chrono::seconds(10);
  std::string how = "over";        ///< of a step
  std::string path;                ///< of a state
  std::vector<std::string> paths;  ///< of breakpoints
  bool clear = false;
};

std::vector<std::string> texts_at(const Value& map, std::string_view key) {
  std::vector<std::string> texts;
  for (const Value& one : list_at(map, key))
    texts.push_back(one.is_string() ? one.as_string() : "");
  return texts;
}

/// The report of the mission that commands the robot. NotFound where none does.
Result<Value> mission_of(control::RobotService& robot) {
  auto status = robot.status();
  if (!status) return status.error();
  const Value* doing = status->find("doing");
  if (doing != nullptr && doing->find("mission") != nullptr) return *doing;
  const std::string who = printable_at(*status, "commanded_by");
  return fail(ErrorCode::NotFound,
              who.empty() ? std::string("no mission commands the robot; `segue mission run FILE` starts one")
                          : "the robot is commanded by " + who +
                                ", which has not reported a mission; if it has just begun, try again");
}

Value control_of(const Value& doing) {
  const Value* control = doing.find("control");
  return control == nullptr ? Value() : *control;
}

bool is_held(const Value& doing) {
  const Value control = control_of(doing);
  const Value* at = control.find("at");
  return at != nullptr && at->is_list();
}

/// "held before fetch/take", "under way: fetch/look", "nothing is under way"
std::string where(const Value& doing) {
  if (is_held(doing)) {
    const auto at = texts_at(control_of(doing), "at");
    return at.empty() ? "held" : "held before " + listed(at);
  }
  const auto running = texts_at(doing, "running");
  return running.empty() ? "nothing is under way" : "under way: " + listed(running);
}

int show_mission(control::RobotService& robot, const Context& context) {
  const auto doing = mission_of(robot);
  if (!doing) return failed(context, doing.error());
  if (context.json()) {
    print_json(*doing);
    return kDone;
  }
  const auto ended = static_cast<std::size_t>(number_at(*doing, "ended"));
  print_line(printable(fmt::format("mission {}: {}; {}; {} {} ended", printable_at(*doing, "mission"),
                                   printable_at(*doing, "state"), where(*doing), counted(ended, "action"),
                                   ended == 1 ? "has" : "have")));
  if (const auto paths = texts_at(control_of(*doing), "breakpoints"); !paths.empty())
    print_line(printable("breakpoints: " + listed(paths)));
  return kDone;
}

/// Sends a request to the mission and waits until `has_followed` is true of its report. Returns the error of
/// a request that it refuses. NotFound once it has ended.
template <class Condition>
Result<Value> ask(control::RobotService& robot, std::string_view what, const Value& arguments,
                  Duration timeout, Condition has_followed) {
  auto doing = mission_of(robot);
  if (!doing) return doing;
  const auto number = robot.send_command(what, arguments);
  if (!number) return number.error();
  const TimePoint deadline = deadline_in(timeout);
  for (doing = mission_of(robot); doing; doing = mission_of(robot)) {
    const Value control = control_of(*doing);
    const Value* problem = control.find("problem");
    const auto asked = static_cast<double>(*number);
    if (problem != nullptr && number_at(*problem, "number") == asked)
      return fail(ErrorCode::InvalidState, printable_at(*problem, "text"));
    if (number_at(control, "heard") >= asked && has_followed(*doing)) break;
    if (RealClock::instance().now() > deadline) {
      return fail(
          ErrorCode::DeadlineExceeded,
          fmt::format("mission {} has not followed yet ({}; {}); watch it with 'segue mission status'",
                      quote(printable_at(*doing, "mission")), printable_at(*doing, "state"), where(*doing)));
    }
    std::this_thread::sleep_for(kPollPeriod);
  }
  return doing;
}

/// `ended`: the state to show for a mission that has ended meanwhile; empty: such an end is a failure.
int show_state(const Result<Value>& doing, const std::string& name, const std::string& ended,
               const Context& context) {
  const bool has_ended = !doing && doing.error().code == ErrorCode::NotFound;
  if (!doing && (!has_ended || ended.empty())) return failed(context, doing.error());
  const std::string state = has_ended ? ended : printable_at(*doing, "state");
  if (context.json()) {
    print_json(Value::map({{"mission", name}, {"state", state}}));
  } else {
    print_line(printable(fmt::format("mission {}: {}", name, state)));
  }
  return kDone;
}

/// Waits until the robot is at rest after a mission that was stopped; null where it need not come to rest.
Result<Value> rest_after(control::RobotService& robot, TimePoint deadline) {
  while (true) {
    const auto status = robot.status();
    if (!status) return status.error();
    const Value* halt = status->find("halt");
    if (halt == nullptr || halt->is_null()) return Value();
    const std::string state = printable_at(*halt, "state");
    if (state != "halting") {
      Value rest = *halt;
      rest.as_map().set("at_rest", state == "at_rest");
      return rest;
    }
    if (RealClock::instance().now() > deadline) {
      return fail(ErrorCode::DeadlineExceeded,
                  "the mission has ended, but the robot is not at rest yet; watch it with 'segue events'");
    }
    std::this_thread::sleep_for(kPollPeriod);
  }
}

int ask_state(control::RobotService& robot, const std::string& what, const std::string& wanted,
              const SteeringOptions& options, const Context& context) {
  const auto now = mission_of(robot);
  if (!now) return failed(context, now.error());
  const auto doing = ask(robot, what, {}, options.timeout,
                         [&](const Value& then) { return printable_at(then, "state") == wanted; });
  const std::string ended = what == "resume" ? "ended" : "";
  return show_state(doing, printable_at(*now, "mission"), ended, context);
}

/// Stops the mission; it counts as stopped when the robot is at rest.
int stop_mission(control::RobotService& robot, const SteeringOptions& options, const Context& context) {
  const TimePoint deadline = deadline_in(options.timeout);
  const auto now = mission_of(robot);
  if (!now) return failed(context, now.error());
  const std::string name = printable_at(*now, "mission");
  const auto doing = ask(robot, "stop", {}, options.timeout, [](const Value&) { return false; });
  if (doing || doing.error().code != ErrorCode::NotFound) return failed(context, doing.error());
  const auto rest = rest_after(robot, deadline);
  if (!rest) return failed(context, rest.error());
  if (rest->is_null()) return show_state(doing, name, "stopped", context);
  if (context.json()) {
    print_json(Value::map({{"mission", name}, {"state", "stopped"}, {"rest", *rest}}));
  } else {
    print_line(rest_text("mission " + name + ": stopped", *rest));
  }
  return is_at_rest(*rest) ? kDone : kFailed;
}

/// Where the mission is once it is held again; that it has ended is not a failure of a step.
int show_place(const Result<Value>& doing, const Context& context) {
  const bool has_ended = !doing && doing.error().code == ErrorCode::NotFound;
  if (!doing && !has_ended) return failed(context, doing.error());
  if (context.json()) {
    print_json(has_ended ? Value::map({{"state", "ended"}}) : *doing);
  } else {
    print_line(has_ended ? "the mission has ended"
                         : printable("mission " + printable_at(*doing, "mission") + ": " + where(*doing)));
  }
  return kDone;
}

int step(control::RobotService& robot, const SteeringOptions& options, const Context& context) {
  if (const auto now = mission_of(robot); !now) return failed(context, now.error());
  return show_place(ask(robot, "step", Value::map({{"how", options.how}}), options.timeout, is_held),
                    context);
}

int go_on_at(control::RobotService& robot, const SteeringOptions& options, const Context& context) {
  const auto now = mission_of(robot);
  if (!now) return failed(context, now.error());
  const bool stays = is_held(*now);
  return show_place(ask(robot, "go_on_at", Value::map({{"at", options.path}}), options.timeout,
                        [stays](const Value& doing) { return !stays || is_held(doing); }),
                    context);
}

/// The breakpoints to be set: the given ones are added to those that are set, or with `clear` removed from
/// them; none given with `clear`: all are removed.
std::vector<std::string> wanted_breakpoints(std::vector<std::string> set, const SteeringOptions& options) {
  const auto& given = options.paths;
  const auto is_given = [&](const std::string& path) {
    return given.empty() || std::ranges::find(given, path) != given.end();
  };
  if (options.clear) {
    std::erase_if(set, is_given);
    return set;
  }
  for (const std::string& path : given) {
    if (std::ranges::find(set, path) == set.end()) set.push_back(path);
  }
  return set;
}

int set_breakpoints(control::RobotService& robot, const SteeringOptions& options, const Context& context) {
  auto doing = mission_of(robot);
  if (!doing) return failed(context, doing.error());
  if (options.clear || !options.paths.empty()) {
    Value::List wanted;
    for (const auto& path : wanted_breakpoints(texts_at(control_of(*doing), "breakpoints"), options))
      wanted.emplace_back(path);
    doing = ask(robot, "break", Value::map({{"at", std::move(wanted)}}), options.timeout,
                [](const Value&) { return true; });
    if (!doing) return failed(context, doing.error());
  }
  const auto paths = texts_at(control_of(*doing), "breakpoints");
  if (context.json()) {
    print_json(Value(Value::List(paths.begin(), paths.end())));
    return kDone;
  }
  for (const auto& path : paths)
    print_line(printable(path));
  if (paths.empty()) print_note("no breakpoints");
  return kDone;
}

void add_ports(Table& table, const Value& values, std::string_view key, const std::string& kind) {
  for (const Value& port : list_at(values, key)) {
    const Value* cut = port.find("cut");
    const bool is_cut = cut != nullptr && *cut == Value(true);
    table.add({kind, printable_at(port, "name"), printable(printable_at(port, "type")),
               printable_at(port, "text") + (is_cut ? " ..." : "")});
  }
}

int show_values(control::RobotService& robot, const SteeringOptions& options, const Context& context) {
  const auto doing = ask(robot, "values", Value::map({{"of", options.path}}), options.timeout,
                         [](const Value&) { return true; });
  if (!doing) return failed(context, doing.error());
  const Value control = control_of(*doing);
  const Value* values = control.find("values");
  if (values == nullptr || printable_at(*values, "of") != options.path) {
    return failed(context, fail(ErrorCode::Superseded, "somebody else asked for other values meanwhile"));
  }
  if (context.json()) {
    print_json(*values);
    return kDone;
  }
  Table table({{"PORT", Table::Align::Left}, {"NAME"}, {"TYPE"}, {"VALUE"}});
  add_ports(table, *values, "inputs", "input");
  add_ports(table, *values, "outputs", "output");
  const std::string when = printable_at(*values, "when");
  print_line(printable((options.path.empty() ? "the mission" : options.path) + ": " +
                       (when == "next" ? "would begin now with"
                        : when.empty() ? "does not run"
                                       : when)));
  print(table.text());
  return kDone;
}

using Action = std::function<int(control::RobotService&, const SteeringOptions&, const Context&)>;

Verb& add_steering(Verb& mission, Context& context, const std::shared_ptr<SteeringOptions>& options,
                   const std::string& name, const std::string& help, const std::string& examples,
                   Action action) {
  Verb& verb = add_verb(mission, context, name, help, examples, [options, action, &context] {
    return with_robot(context,
                      [&](control::RobotService& robot) { return action(robot, *options, context); });
  });
  verb.option("--timeout DURATION", options->timeout, "how long to wait until it is (default 10s)");
  add_robot_option(verb, context);
  return verb;
}

void add_request(Verb& mission, Context& context, const char* what, const char* wanted, const char* help) {
  add_steering(
      mission, context, std::make_shared<SteeringOptions>(), what, help,
      fmt::format("  segue mission {}", what),
      [what, wanted](control::RobotService& robot, const SteeringOptions& options, const Context& chosen) {
        return ask_state(robot, what, wanted, options, chosen);
      });
}

void add_steps(Verb& mission, Context& context) {
  const auto stepping = std::make_shared<SteeringOptions>();
  add_steering(mission, context, stepping, "step",
               "carry out one step of a held mission that runs sequentially, and say where it is then",
               "  segue mission step            # the next state with everything in it\n"
               "  segue mission step into       # the next state; if it has states, only enter it\n"
               "  segue mission step out        # to the end of the state around\n"
               "  segue mission step back       # undo the last action (segue mission run --steps-back)",
               step)
      .option("HOW", stepping->how, "over (default), into, out or back")
      .one_of({"over", "into", "out", "back"});

  const auto breaking = std::make_shared<SteeringOptions>();
  Verb& verb = add_steering(mission, context, breaking, "break",
                            "set breakpoints: states before which the mission is held; or list them",
                            "  segue mission break fetch/grasp\n"
                            "  segue mission break                     # lists them\n"
                            "  segue mission break --clear fetch/grasp\n"
                            "  segue mission break --clear             # all",
                            set_breakpoints);
  verb.option("PATH", breaking->paths, "states, such as fetch/grasp");
  verb.flag("--clear", breaking->clear, "remove these, or all");

  const auto going = std::make_shared<SteeringOptions>();
  add_steering(mission, context, going, "go-on-at",
               "let the mission go on at another state; what is under way around it is preempted",
               "  segue mission go-on-at fetch/grasp\n\nWhere the mission is held it stays held, before that "
               "state.",
               go_on_at)
      .option("PATH", going->path, "a state, such as fetch/grasp")
      .required();

  const auto looking = std::make_shared<SteeringOptions>();
  add_steering(mission, context, looking, "values", "show the values at the inputs and outputs of a state",
               "  segue mission values fetch/grasp", show_values)
      .option("PATH", looking->path, "a state, such as fetch/grasp; none: the mission");
}

}  // namespace

void add_mission_steering(Verb& mission, Context& context) {
  Verb& status = add_verb(mission, context, "status", "show what the mission that commands a robot is doing",
                          "  segue mission status", [&context] {
                            return with_robot(context, [&](control::RobotService& robot) {
                              return show_mission(robot, context);
                            });
                          });
  add_robot_option(status, context);
  add_request(mission, context, "pause", "paused",
              "let the mission that commands a robot begin nothing more; what is under way goes on");
  add_request(mission, context, "resume", "running", "let a paused mission go on");
  add_steering(
      mission, context, std::make_shared<SteeringOptions>(), "stop",
      "stop the mission that commands a robot: what is under way is preempted, and the robot comes to rest",
      "  segue mission stop", stop_mission);
  add_steps(mission, context);
}

}  // namespace segue::cli

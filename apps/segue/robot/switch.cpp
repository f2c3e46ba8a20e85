// SPDX-License-Identifier: Apache-2.0
#include <segue/base/input_file.hpp>
#include <segue/base/text.hpp>
#include <segue/model/controller_names.hpp>
#include <segue/type/yaml.hpp>

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <memory>

#include "../connection.hpp"
#include "../report_text.hpp"
#include "followed_request.hpp"

namespace segue::cli {

namespace {

using type::Value;

struct SwitchVerbOptions {
  std::string controller;
  std::string network;     ///< a file; empty: to the controller
  std::string transition;  ///< a file, or a name of the robot's; empty: to the controller
  std::string order;
  bool dry_run = false;
  bool force = false;
  bool take_over = false;
  std::vector<std::string> properties;  ///< TASK.PROPERTY=VALUE
  bool wait = true;
  Duration timeout = std::chrono::seconds(60);
};

int show_plan(const Value& transition, const Context& context) {
  if (context.json()) {
    print_json(transition);
  } else {
    print(describe_transition(transition) + changes_of(transition));
  }
  return kDone;
}

int show_requested(const SwitchVerbOptions& options, const Context& context) {
  const char* kind = !options.transition.empty() ? "transition" : !options.network.empty() ? "network" : "to";
  const std::string& what = !options.transition.empty() ? options.transition
                            : !options.network.empty()  ? options.network
                                                        : options.controller;
  if (context.json()) {
    print_json(Value::map({{"outcome", "requested"}, {kind, what}}));
  } else {
    print_line("requested " + what + "; `segue status` shows its progress");
  }
  return kDone;
}

/// An unknown name is the likeliest mistake: lists the robot's controllers.
void suggest_controllers(control::RobotService& robot, const std::string& controller) {
  const auto status = robot.status();
  if (!status) return;
  const auto names = names_at(*status, "controllers");
  const bool all_known = std::ranges::all_of(model::controllers_in(controller), [&](const auto& one) {
    return std::ranges::find(names, one.str()) != names.end();
  });
  if (!all_known)
    print_note(names.empty() ? "the robot has no controllers" : "the robot's controllers: " + listed(names));
}

/// A switch takes controllers as they were loaded: says so where files have changed since.
void note_changed_files(control::RobotService& robot) {
  const auto status = robot.status();
  if (!status) return;
  std::vector<std::string> files;
  for (const Value& change : list_at(*status, "changed_files"))
    files.push_back(printable_at(change, "file"));
  if (files.empty()) return;
  print_note("changed since the robot loaded them: " + listed(files) +
             "; `segue plan` shows what that changes, `segue apply` does it");
}

/// The name by which the robot is asked for the network: "empty", where the robot has no controller of that
/// name, and "-" are the empty network, like for `segue diff`.
std::string name_for(control::RobotService& robot, const std::string& said) {
  if (said == "-") return {};
  if (said != kEmptyNetwork) return said;
  const auto status = robot.status();
  const bool is_controller = status && std::ranges::count(names_at(*status, "controllers"), said) > 0;
  return is_controller ? said : std::string();
}

/// "TASK.PROPERTY=VALUE"
Result<control::PropertySetting> parse_property(const std::string& text) {
  const auto equals = text.find('=');
  const auto dot = text.substr(0, equals).find('.');
  if (equals == std::string::npos || dot == std::string::npos)
    return fail(ErrorCode::InvalidArgument, "--set must be TASK.PROPERTY=VALUE, got " + quote(text));
  auto value = type::parse_yaml(text.substr(equals + 1));
  if (!value) return value.error();
  return control::PropertySetting{model::TaskId(text.substr(0, dot)), text.substr(dot + 1, equals - dot - 1),
                                  std::move(*value)};
}

/// Whether this names a file, and no transition of the robot: it has a folder or an ending.
bool is_file(const std::string& transition) {
  const auto ends = [&](std::string_view ending) { return transition.ends_with(ending); };
  return transition.find('/') != std::string::npos || ends(".yaml") || ends(".yml") || ends(".json");
}

Result<Value> request_switch(control::RobotService& robot, const SwitchVerbOptions& options) {
  const TimePoint deadline = deadline_in(options.wait ? options.timeout : Duration(0));
  const auto order = model::order_named(options.order);
  if (!order) return order.error();
  control::RequestOptions asked{
      .order = *order, .force = options.force, .who = sender("switch"), .take_over = options.take_over};
  for (const std::string& text : options.properties) {
    auto property = parse_property(text);
    if (!property) return property.error();
    asked.properties.push_back(std::move(*property));
  }
  if (options.transition.empty() && options.network.empty()) {
    const std::string controller = name_for(robot, options.controller);
    return options.dry_run ? robot.diff(controller, asked, deadline)
                           : robot.switch_to(controller, asked, deadline);
  }
  if (!options.transition.empty() && !is_file(options.transition))
    return robot.apply_transition({.name = options.transition}, asked, deadline);
  const std::string& file = options.network.empty() ? options.transition : options.network;
  const auto text = options.network.empty() ? read_input_file(file) : network_text(file);
  if (!text) return text.error();
  if (options.network.empty()) return robot.apply_transition({.text = *text, .file = file}, asked, deadline);
  return options.dry_run ? robot.diff_to_network(*text, file, asked, deadline)
                         : robot.switch_to_network(*text, file, asked, deadline);
}

int switch_robot(control::RobotService& robot, const SwitchVerbOptions& options, StopSignal* signal,
                 const Context& context) {
  const auto answer =
      follow_request(sender("switch"), signal, context, [&] { return request_switch(robot, options); });
  const bool only_late = !answer && answer.error().code == ErrorCode::DeadlineExceeded;
  if (!options.wait && only_late) return show_requested(options, context);
  const bool refused = answer && printable_at(*answer, "outcome") == "refused";
  if (answer && options.dry_run && !refused) return show_plan(*answer, context);
  const int status = answer ? show_outcome(*answer, context) : failed(context, answer.error());
  if (options.transition.empty() && options.network.empty()) {
    if (status == kFailed) suggest_controllers(robot, options.controller);
    if (status == kDone && !context.json()) note_changed_files(robot);
  }
  return status;
}

/// The options that say what is switched to, and how.
void add_what(Verb& verb, SwitchVerbOptions& options) {
  const Option name =
      verb.option("NAME", options.controller,
                  "the controller, or several at once (drive+arm); `empty` is the empty network");
  const Option file = verb.option("--transition NAME|FILE", options.transition,
                                  "execute this transition of the robot, or of this file (which has a folder "
                                  "or an ending in its name), instead of a switch to NAME")
                          .excludes(name);
  const Option network =
      verb.option("--network FILE", options.network,
                  "send this network file to the robot and switch to it, under its own name")
          .excludes(name)
          .excludes(file);
  verb.flag("--dry-run", options.dry_run, "only show the transition").excludes(file);
  verb.flag("--force", options.force,
            "kill the processes to be removed instead of stopping their tasks; for tasks that hang")
      .excludes(file);
  verb.option("--set TASK.PROPERTY=VALUE", options.properties,
              "a property in place of the network's, until the next switch; may be repeated")
      .excludes(file);
  verb.flag("--take-over", options.take_over,
            "also where somebody else, such as a mission, commands the robot; ends what that does");
  add_order_option(verb, options.order).excludes(file);
  verb.require_any({name, file, network}, "NAME, --network FILE or --transition NAME|FILE");
}

}  // namespace

void add_switch(Verb& app, Context& context) {
  const auto options = std::make_shared<SwitchVerbOptions>();
  Verb& verb = add_verb(
      app, context, "switch", "request a controller of a running robot",
      "  segue switch explore\n  segue switch explore --dry-run    # only show the transition\n"
      "  segue switch drive+arm            # two controllers at once\n"
      "  segue switch drive --set planner.speed=0.4   # a variant of it\n"
      "  segue switch --network try.yaml   # a network that is none of the robot's controllers\n"
      "  segue switch --transition restart # execute a transition of the robot, or of a file: t.yaml\n\n"
      "Ctrl-C cancels the request (see `segue cancel`); a second one ends the command and leaves the request "
      "to\nthe robot.",
      [options, &context] {
        std::optional<StopSignal> signal;  // before any other thread
        if (options->wait && !options->dry_run) signal.emplace();
        return with_robot(context, [&](control::RobotService& robot) {
          return switch_robot(robot, *options, signal ? &*signal : nullptr, context);
        });
      });
  add_what(verb, *options);
  verb.flag("--wait,!--no-wait", options->wait,
            "wait for the outcome (default); --no-wait returns after the request");
  verb.option("--timeout DURATION", options->timeout, "how long to wait for the outcome (default 60s)");
  add_robot_option(verb, context);
}

}  // namespace segue::cli

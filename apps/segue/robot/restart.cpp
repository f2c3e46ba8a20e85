// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/type/yaml.hpp>

#include <algorithm>
#include <memory>
#include <optional>

#include "../connection.hpp"
#include "../report_text.hpp"
#include "followed_request.hpp"

namespace segue::cli {

namespace {

using type::Value;

struct RestartOptions {
  std::vector<std::string> tasks;
  bool take_over = false;
  Duration timeout = std::chrono::seconds(60);
};

Result<Value> find_task(const Value& status, const std::string& id) {
  const auto& tasks = list_at(status, "tasks");
  const auto task = std::ranges::find(tasks, id, [](const Value& one) { return printable_at(one, "id"); });
  if (task != tasks.end()) return *task;
  return no_such_task(id, task_names(status));
}

/// The actions that take a task in this state through pre-operational and back; nothing for other states.
std::optional<std::vector<std::string>> actions_for(const std::string& state) {
  if (state == "running") return std::vector<std::string>{"stop", "cleanup", "configure", "start"};
  if (state == "stopped") return std::vector<std::string>{"cleanup", "configure"};
  return std::nullopt;
}

/// A transition file that restarts the tasks, each on its own.
Result<std::string> restart_transition(const Value& status, const std::vector<std::string>& tasks) {
  Value::List actions;
  for (const std::string& id : tasks) {
    const auto task = find_task(status, id);
    if (!task) return task.error();
    const std::string state = printable_at(*task, "state");
    const auto kinds = actions_for(state);
    if (!kinds) {
      const bool is_idle = state == "pre_operational";
      return fail(
          ErrorCode::InvalidState,
          "is " + state + (is_idle ? ", so there is nothing to restart" : "; `segue repair` makes it anew"),
          id);
    }
    for (const std::string& kind : *kinds) {
      const auto number = static_cast<std::int64_t>(actions.size()) + 1;
      Value action = Value::map({{"id", number}, {"kind", kind}, {"task", id}});
      if (kind != kinds->front()) action.as_map().set("after", Value::list({number - 1}));
      actions.push_back(std::move(action));
    }
  }
  const Value controller = printable_at(status, "controller");
  return type::to_yaml(Value::map(
      {{"transition",
        Value::map({{"from", controller}, {"to", controller}, {"actions", std::move(actions)}})}}));
}

int restart(control::RobotService& robot, const RestartOptions& options, StopSignal& signal,
            const Context& context) {
  const auto status = robot.status();
  if (!status) return failed(context, status.error());
  const auto text = restart_transition(*status, options.tasks);
  if (!text) return failed(context, text.error());
  const control::RequestOptions asked{.who = sender("restart"), .take_over = options.take_over};
  const auto answer = follow_request(asked.who, &signal, context, [&] {
    return robot.apply_transition({.text = *text, .file = "restart"}, asked, deadline_in(options.timeout));
  });
  return answer ? show_outcome(*answer, context) : failed(context, answer.error());
}

}  // namespace

void add_restart(Verb& app, Context& context) {
  const auto options = std::make_shared<RestartOptions>();
  Verb& verb = add_verb(
      app, context, "restart", "stop, clean up, configure and start tasks again",
      "  segue restart laser\n  segue restart laser camera\n\n"
      "All of it is one transition: where a task fails, what was done is undone. Processes run on; a task in "
      "an\n"
      "error state, or one that hangs, is made anew by `segue repair`. Ctrl-C cancels the request.",
      [options, &context] {
        StopSignal signal;  // before any other thread
        return with_robot(
            context, [&](control::RobotService& robot) { return restart(robot, *options, signal, context); });
      });
  verb.option("TASK", options->tasks, "the tasks' ids").required();
  verb.flag("--take-over", options->take_over,
            "also where somebody else, such as a mission, commands the robot; ends what that does");
  verb.option("--timeout DURATION", options->timeout, "how long to wait for the outcome (default 60s)");
  add_robot_option(verb, context);
}

}  // namespace segue::cli

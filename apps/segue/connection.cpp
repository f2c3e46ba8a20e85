// SPDX-License-Identifier: Apache-2.0
#include "connection.hpp"

#include <segue/base/text.hpp>

#include <fmt/core.h>

#include <unistd.h>

#include <algorithm>

namespace segue::cli {

namespace {

using type::Value;

Error not_running(const std::string& robot, const std::vector<std::string>& running) {
  if (running.empty()) {
    return fail(ErrorCode::Unavailable, (robot.empty() ? std::string("no robot is running")
                                                       : "robot " + quote(robot) + " is not running") +
                                            "; start one with `segue run ROBOT_FILE`");
  }
  return fail(ErrorCode::Unavailable, fmt::format("robot {} is not running{}; running: {}", quote(robot),
                                                  did_you_mean(robot, running), listed(running)));
}

/// The name to connect to, or the exit status.
std::pair<std::string, int> choose(Context& context) {
  if (!context.robot.empty()) return {context.robot, kDone};
  const auto running = control::running_robots();
  if (running.size() == 1) return {running.front(), kDone};
  if (running.empty()) return {"", failed(context, not_running("", running))};
  print_error(context, fail(ErrorCode::InvalidArgument,
                            fmt::format("{} robots are running: {}; select one with --robot NAME",
                                        running.size(), listed(running))));
  return {"", kUsage};
}

}  // namespace

Result<std::unique_ptr<control::RobotService>> connect_to(std::string_view robot, Duration timeout) {
  const auto socket = control::socket_path(robot);
  if (!socket) return socket.error();
  return control::connect(*socket, timeout);
}

std::pair<std::unique_ptr<control::RobotService>, int> reach(Context& context) {
  const auto [name, status] = choose(context);
  if (name.empty()) return {nullptr, status};
  context.robot = name;
  const auto socket = control::socket_path(name);
  if (!socket) return {nullptr, failed(context, socket.error())};
  auto robot = control::connect(*socket);
  if (robot) return {std::move(*robot), kDone};
  const bool nobody = robot.error().code == ErrorCode::Unavailable && !std::filesystem::exists(*socket);
  print_error(context, nobody ? not_running(name, control::running_robots()) : robot.error());
  return {nullptr, kUnreachable};
}

int with_robot(Context& context, const std::function<int(control::RobotService&)>& use) {
  const auto [robot, status] = reach(context);
  return robot ? use(*robot) : status;
}

std::vector<std::string> names_at(const Value& status, std::string_view key) {
  std::vector<std::string> names;
  for (const Value& name : list_at(status, key)) {
    if (name.is_string()) names.push_back(name.as_string());
  }
  return names;
}

std::vector<std::string> task_names(const Value& status) {
  std::vector<std::string> names;
  for (const Value& task : list_at(status, "tasks"))
    names.push_back(printable_at(task, "id"));
  return names;
}

control::Sender sender_of(std::string_view verb, bool beside) {
  return {.who = sender(verb), .beside_mission = beside};
}

void add_beside_option(Verb& verb, bool& beside) {
  verb.flag(
      "--beside-mission", beside,
      "although a mission commands the robot, and beside what that is doing; otherwise it is refused then");
}

std::string sender(std::string_view verb) {
  return fmt::format("segue {} (pid {}, uid {})", verb, ::getpid(), ::getuid());
}

Error no_such_task(const std::string& id, const std::vector<std::string>& tasks) {
  return fail(ErrorCode::NotFound, "the robot has no such task" + did_you_mean_or_list(id, tasks, "running:"),
              id);
}

namespace {

/// The error about a task that does not run, which `names` do: it may be lost, or be no task of the
/// controller.
Error unknown_task(const Value& status, const std::string& wanted, const std::vector<std::string>& names) {
  const auto differences = names_at(status, "differences");
  if (std::ranges::find(differences, "task " + quote(wanted) + " is missing") != differences.end()) {
    return fail(
        ErrorCode::NotFound,
        "task " + quote(wanted) + " is missing; `segue status` says why, `segue repair` starts it anew");
  }
  const std::string known = names.empty() ? "; no task is running" : "; running: " + listed(names);
  return fail(ErrorCode::NotFound,
              fmt::format("the robot has no task {}{}{}", quote(wanted), did_you_mean(wanted, names), known));
}

}  // namespace

Result<Address> resolve(control::RobotService& robot, std::string_view text, std::string_view what) {
  if (text.find('.') == std::string_view::npos) {
    return fail(ErrorCode::InvalidArgument,
                fmt::format("{} does not name a member; write TASK.{}", quote(text), what, what));
  }
  const auto status = robot.status();
  if (!status) return status.error();
  const auto names = task_names(*status);
  Address best;
  for (const std::string& name : names) {
    const bool fits =
        text.size() > name.size() + 1 && text.substr(0, name.size()) == name && text[name.size()] == '.';
    if (fits && name.size() > best.task.size()) best = {name, std::string(text.substr(name.size() + 1))};
  }
  if (!best.task.empty()) return best;
  return unknown_task(*status, std::string(text.substr(0, text.find('.'))), names);
}

std::vector<std::string> port_names(const type::Value& task, std::string_view direction) {
  std::vector<std::string> names;
  for (const type::Value& port : list_at(task, "ports")) {
    const auto* pattern = port.find("pattern");
    const bool is_family = pattern != nullptr && pattern->as_bool();
    if (!is_family && printable_at(port, "direction") == direction)
      names.push_back(printable_at(port, "name"));
  }
  return names;
}

}  // namespace segue::cli

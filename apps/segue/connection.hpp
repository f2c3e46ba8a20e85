// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/control/robot_service.hpp>
#include <segue/control/server.hpp>

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "command.hpp"
#include "output.hpp"

/// Verbs that talk to a running robot.
namespace segue::cli {

/// Connects to the running robot of that name.
Result<std::unique_ptr<control::RobotService>> connect_to(std::string_view robot,
                                                          Duration timeout = std::chrono::seconds(5));

/// Connects to the robot of --robot, or to the only one running (whose name is then in the context). Problems
/// are printed on standard error; then the first part is null and the second is the exit status.
std::pair<std::unique_ptr<control::RobotService>, int> reach(Context& context);

/// reach(), then `use`.
int with_robot(Context& context, const std::function<int(control::RobotService&)>& use);

/// "task.port" or "task.property.part": the longest task id of the robot that matches, then the rest.
/// NotFound and InvalidArgument name the tasks there are.
struct Address {
  std::string task;
  std::string member;
};
Result<Address> resolve(control::RobotService& robot, std::string_view text, std::string_view what);

/// NotFound, of a task that the robot does not have among `tasks`.
Error no_such_task(const std::string& id, const std::vector<std::string>& tasks);

/// Names from a status: "controllers" and "transitions", or the ids of "tasks".
std::vector<std::string> names_at(const type::Value& status, std::string_view key);
std::vector<std::string> task_names(const type::Value& status);

/// The sender of a command; `beside`: it may be carried out although somebody else commands the robot.
control::Sender sender_of(std::string_view verb, bool beside);
/// --beside-mission, for such verbs.
void add_beside_option(Verb& verb, bool& beside);

/// The sender of a request, for the journal: "segue switch (pid 12, uid 1000)".
std::string sender(std::string_view verb);

inline TimePoint deadline_in(Duration duration) {
  return RealClock::instance().now() + duration;
}

/// The names of a task's ports ("input" or "output"), without families of dynamic ports. `task`: as of
/// RobotService::task().
std::vector<std::string> port_names(const type::Value& task, std::string_view direction);

}  // namespace segue::cli

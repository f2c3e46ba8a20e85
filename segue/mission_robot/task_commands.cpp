// SPDX-License-Identifier: Apache-2.0
#include <segue/mission_robot/task_commands.hpp>

#include <algorithm>
#include <utility>

namespace segue::mission {

TaskCommands::TaskCommands(CommandedRobot& robot, const ControllerUse& use, Duration answer_deadline)
    : robot_(robot), answer_deadline_(answer_deadline) {
  for (const MemberValue& one : use.call)
    commands_.push_back({&one, false});
  for (const MemberValue& one : use.write)
    commands_.push_back({&one, true});
}

Result<void> TaskCommands::give(const std::stop_token& stop) {
  for (Command& command : commands_) {
    if (command.is_given) continue;
    if (stop.stop_requested()) return no_longer_wanted();
    if (auto given = give(command, stop); !given) return given;
    command.is_given = true;
  }
  return {};
}

Result<void> TaskCommands::give(Command& command, const std::stop_token& stop) {
  const Wait wait(RealClock::instance().now() + answer_deadline_, stop);
  const auto& [member, value, _] = *command.what;
  if (command.is_sample) return robot_.write(member, value, wait);
  if (auto called = robot_.call(member, value, wait); !called) return called.error();
  return {};
}

void TaskCommands::skip() {
  for (Command& command : commands_)
    command.is_given = true;
}

bool TaskCommands::forget(const std::string& task) {
  bool had_been_told = false;
  for (Command& command : commands_) {
    if (command.what->member.task == task)
      had_been_told = std::exchange(command.is_given, false) || had_been_told;
  }
  return had_been_told;
}

bool TaskCommands::are_given() const {
  return std::ranges::all_of(commands_, &Command::is_given);
}

}  // namespace segue::mission

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/mission/commanded_robot.hpp>
#include <segue/mission/controller_use.hpp>

#include <stop_token>
#include <string>
#include <vector>

namespace segue::mission {

/// The commands of an action to the tasks of its controller: calls of operations first, then samples, each in
/// the order in which it was written. Knows which of them have been given, so that a task that begins anew is
/// given its own again, and no other task gets a command twice. One thread uses this.
class TaskCommands {
 public:
  /// `robot` and `use` must outlive this. `answer_deadline`: for each of them.
  TaskCommands(CommandedRobot& robot, const ControllerUse& use, Duration answer_deadline);

  /// Gives those that have not been given. The error of the first that fails: this one and those after it
  /// have not been given then. Cancelled, at once, where a stop is requested.
  Result<void> give(const std::stop_token& stop);
  /// Counts all as given, by an earlier run.
  void skip();
  /// Notes that the task does not have its commands any more; false: it had been given none.
  bool forget(const std::string& task);
  [[nodiscard]] bool are_given() const;

 private:
  struct Command {
    const MemberValue* what;
    bool is_sample;
    bool is_given = false;
  };
  Result<void> give(Command& command, const std::stop_token& stop);

  CommandedRobot& robot_;
  const Duration answer_deadline_;
  std::vector<Command> commands_;
};

}  // namespace segue::mission

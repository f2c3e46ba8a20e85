// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/condition.hpp>
#include <segue/type/value.hpp>

#include <string>
#include <string_view>
#include <variant>

namespace segue::model {

/// A port, a property or an operation of a task: "planner.speed.max" is `speed.max` of `planner`.
struct Member {
  std::string task;
  std::string name;
  friend bool operator==(const Member&, const Member&) = default;
};
/// Both parts are empty where the text has no dot.
Member parse_member(std::string_view text);
std::string to_string(const Member& member);

/// A task is in that state: one that its component declares ("arrived"), or "running", "stopped" and so on.
struct TaskReaches {
  std::string task;
  std::string state;
  friend bool operator==(const TaskReaches&, const TaskReaches&) = default;
};
/// A sample of the port fulfils the condition.
struct SampleShows {
  Member port;
  Condition what;
  friend bool operator==(const SampleShows&, const SampleShows&) = default;
};
/// An operation without arguments answers that.
struct OperationAnswers {
  Member operation;
  type::Value is;
  friend bool operator==(const OperationAnswers&, const OperationAnswers&) = default;
};

/// A condition on a robot: it ends an action of a mission, binds a fact, or tells that the robot is at rest.
using RobotCondition = std::variant<TaskReaches, SampleShows, OperationAnswers>;

/// The task that the condition is about.
const std::string& task_of(const RobotCondition& condition);
/// The condition as a sentence which says that it holds: "task 'arm' is holding".
std::string sentence(const RobotCondition& condition);
/// The condition as a sentence which says that it does not hold: "task 'arm' is not holding".
std::string denial(const RobotCondition& condition);

}  // namespace segue::model

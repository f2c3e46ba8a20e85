// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/mission/condition.hpp>
#include <segue/mission/port.hpp>
#include <segue/type/value.hpp>

#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace segue::mission {

/// A port, a property or an operation of a task: "planner.speed.max" is `speed.max` of `planner`.
struct Member {
  std::string task;
  std::string name;
  friend bool operator==(const Member&, const Member&) = default;
};
/// Both parts are empty where the text has no dot.
Member parse_member(std::string_view text);
std::string to_string(const Member& member);

/// What a property is set to, or an operation is called with. The text "{input}", at any depth, stands for
/// the value of that input.
struct MemberValue {
  Member member;
  type::Value value;
  SourcePlace where;
  friend bool operator==(const MemberValue&, const MemberValue&) = default;
};

/// Which port an output is read from when the action ends.
struct OutputSource {
  std::string output;
  Member port;
  SourcePlace where;
  friend bool operator==(const OutputSource&, const OutputSource&) = default;
};

/// A task is in that state: one that its component declares ("arrived"), or "running", "stopped" and so on.
struct TaskReaches {
  std::string task;
  std::string state;
  friend bool operator==(const TaskReaches&, const TaskReaches&) = default;
};
struct SampleShows {
  Member port;
  Condition what;
  friend bool operator==(const SampleShows&, const SampleShows&) = default;
};
/// An operation without arguments is called again and again until it answers that.
struct OperationAnswers {
  Member operation;
  type::Value is;
  friend bool operator==(const OperationAnswers&, const OperationAnswers&) = default;
};
/// Since the controller runs and has been told what to do.
struct TimeIsUp {
  Duration after{};
  friend bool operator==(const TimeIsUp&, const TimeIsUp&) = default;
};

/// Ends the action with `outcome`, which may be "aborted".
struct EndCondition {
  std::variant<TimeIsUp, TaskReaches, SampleShows, OperationAnswers> when;
  std::string outcome;
  SourcePlace where;
  friend bool operator==(const EndCondition&, const EndCondition&) = default;
};

/// An action that a controller of the robot carries out: it is requested, told what to do, and watched until
/// the first of `until` holds.
struct ControllerUse {
  std::string controller;           ///< "{input}" in it stands for the value of that input
  std::vector<MemberValue> set;     ///< properties in place of those of its network
  std::vector<MemberValue> call;    ///< operations with their arguments by name, once the controller runs
  std::vector<MemberValue> write;   ///< samples to input ports, after the operations
  std::vector<EndCondition> until;  ///< the first that holds; empty: the action ends once the controller runs
  std::vector<OutputSource> outputs;
  bool stop =
      false;  ///< the robot stops afterwards; otherwise the controller runs on until another is needed
  friend bool operator==(const ControllerUse&, const ControllerUse&) = default;
};

}  // namespace segue::mission

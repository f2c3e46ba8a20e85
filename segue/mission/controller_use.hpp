// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/mission/mission_port.hpp>
#include <segue/model/robot_condition.hpp>
#include <segue/type/value.hpp>

#include <string>
#include <variant>
#include <vector>

namespace segue::mission {

using model::Condition;
using model::Member;
using model::OperationAnswers;
using model::parse_member;
using model::RobotCondition;
using model::SampleShows;
using model::TaskReaches;

/// A value for a property or for a call of an operation. The text "{input}", at any depth, stands for the
/// value of that input.
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

/// Since the controller runs and has been told what to do.
struct TimeIsUp {
  Duration after{};
  friend bool operator==(const TimeIsUp&, const TimeIsUp&) = default;
};

/// Ends the action with `outcome`, which may be "aborted".
struct EndCondition {
  std::variant<TimeIsUp, RobotCondition> when;
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

/// The condition if it is one of that kind on the robot; else null.
template <class Kind>
const Kind* condition_of(const EndCondition& condition) {
  const auto* seen = std::get_if<RobotCondition>(&condition.when);
  return seen == nullptr ? nullptr : std::get_if<Kind>(seen);
}

/// Whether something other than time ends it, or it ends at once.
bool can_be_watched(const ControllerUse& use);
/// Whether it ends, as it says itself, when that task fails.
bool awaits_failure(const ControllerUse& use, const std::string& task);

}  // namespace segue::mission

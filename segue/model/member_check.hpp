// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/model/component_model.hpp>
#include <segue/model/network.hpp>
#include <segue/model/robot_condition.hpp>
#include <segue/type/value.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace segue::model {

/// Checks what a mission or a robot file asks of the tasks of one controller by their names. Components that
/// are not known, and ports of those that say that their models are incomplete, may have anything.
class MemberCheck {
 public:
  /// `what` asks, for messages: "action 'grasp'". The references must outlive this.
  MemberCheck(std::string what, const Network& controller, const ComponentCatalog& catalog,
              Diagnostics& diagnostics)
      : what_(std::move(what)), controller_(controller), catalog_(catalog), diagnostics_(diagnostics) {}

  /// "speed.max": only the first part counts.
  void property(const Member& member, const SourceLocation& where);
  /// `arguments` by name; neither null nor a map: they may be anything.
  void call(const Member& operation, const type::Value& arguments, const SourceLocation& where);
  void port(const Member& port, Direction direction, const SourceLocation& where);
  void condition(const RobotCondition& condition, const SourceLocation& where);

 private:
  void error(std::string code, const std::string& message, const SourceLocation& where);
  /// The component model of a task; nullptr, with an error, if there is no such task, and without one if its
  /// component is not known.
  const ComponentModel* component_of(const std::string& task, const SourceLocation& where);
  void no_member(std::string_view kind, const Member& member, const std::vector<std::string>& names,
                 const SourceLocation& where);
  const OperationModel* find_operation(const Member& member, const SourceLocation& where);
  void check(const SampleShows& when, const SourceLocation& where);
  void check(const OperationAnswers& when, const SourceLocation& where);
  void check(const TaskReaches& when, const SourceLocation& where);

  const std::string what_;
  const Network& controller_;
  const ComponentCatalog& catalog_;
  Diagnostics& diagnostics_;
};

}  // namespace segue::model

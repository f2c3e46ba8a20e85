// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/reader.hpp>
#include <segue/model/robot_condition.hpp>

#include <string>
#include <string_view>
#include <vector>

/// Conditions in files, for this folder and those above.
namespace segue::model::detail {

/// "planner.goal" as its parts; an error where it is none. `what` names the place in messages.
Member read_member(std::string_view text, std::string_view example, const std::string& what,
                   const type::Value& at, const Source& source);
/// Reads the conditions of the keys {task, state}, {port, where} and {call, is} of an entry, as many as there
/// are.
std::vector<RobotCondition> read_conditions(Fields& fields, const Source& source);
type::Value write_condition(const RobotCondition& condition);

}  // namespace segue::model::detail

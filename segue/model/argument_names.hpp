// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/component_model.hpp>
#include <segue/type/value.hpp>

#include <string>
#include <vector>

namespace segue::model {

/// An argument that a call lacks ("missing-argument"), or gives although the operation does not have it
/// ("unknown-argument"). `text`: "needs the argument 'goal'".
struct ArgumentProblem {
  std::string code;
  std::string text;
};

/// All problems with the names of arguments that are given in a map, or null: none is given. First those that
/// are lacking.
[[nodiscard]] std::vector<ArgumentProblem> check_argument_names(const OperationModel& operation,
                                                                const type::Value& given);

}  // namespace segue::model

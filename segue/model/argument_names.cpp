// SPDX-License-Identifier: Apache-2.0
#include <segue/base/names_of.hpp>
#include <segue/base/text.hpp>
#include <segue/model/argument_names.hpp>

#include <algorithm>

namespace segue::model {

std::vector<ArgumentProblem> check_argument_names(const OperationModel& operation, const type::Value& given) {
  std::vector<ArgumentProblem> problems;
  const auto names = names_of(operation.arguments);
  for (const std::string& name : names) {
    if (given.find(name) == nullptr)
      problems.push_back({"missing-argument", "needs the argument " + quote(name)});
  }
  if (given.is_null()) return problems;
  for (const auto& [name, value] : given.as_map()) {
    if (std::ranges::find(names, name) == names.end())
      problems.push_back({"unknown-argument", "has no argument " + quote(name) + did_you_mean(name, names)});
  }
  return problems;
}

}  // namespace segue::model

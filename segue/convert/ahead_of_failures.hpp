// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/mission/program.hpp>
#include <segue/task_network/acts_ahead.hpp>

#include <cstddef>
#include <memory>
#include <vector>

namespace segue::convert {

/// The states that may act in a concurrent run although an earlier state fails, and those that may sense
/// before an earlier state has acted.
struct AheadOfFailures {
  std::vector<task_network::NamedActsAhead> pairs;  ///< paths of states
  std::vector<task_network::NamedSensesAhead>
      senses{};          ///< what may sense before something earlier has acted
  bool complete = true;  ///< else the mission is longer than the `most` nodes that were examined
};

/// Nodes that are examined unless told otherwise.
inline constexpr std::size_t kMostExamined = 4000;

/// For every path that the mission may take: the states that act although an earlier state aborts and nobody
/// handles that, and the sensing ones that may observe reality before an earlier state has acted. Three
/// rounds of each loop stand for all; where facts or resources are named by values that are not known before
/// the run, all that they might permit is in the list. The errors of MissionPlan::create.
[[nodiscard]] Result<AheadOfFailures> ahead_of_failures(std::shared_ptr<const mission::Program> program,
                                                        std::vector<type::Value> inputs = {},
                                                        const std::vector<mission::Fact>& facts = {},
                                                        std::size_t most = kMostExamined);

}  // namespace segue::convert

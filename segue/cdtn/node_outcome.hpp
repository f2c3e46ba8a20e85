// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/cdtn/environment.hpp>
#include <segue/cdtn/task_network.hpp>

#include <optional>
#include <string>
#include <vector>

namespace segue::cdtn {

/// What the end of a node means, whoever runs it.
struct NodeOutcome {
  OutcomeId outcome = kSuccess;
  bool as_declared = false;      ///< the declared effects came true
  std::vector<Literal> effects;  ///< else, what became true
  std::optional<Error> failure;  ///< set if the mission cannot go on
};

/// Compares what was observed with what the node declares. Another effect than declared is a failure that
/// names the node, unless it is `uncertain` (other values of the same facts) or `opaque` (anything); so is an
/// abort that nobody handles, and an outcome that leads nowhere.
NodeOutcome judge(const TaskNetwork& network, NodeId node, const Report* report);

/// The failure of a node one of whose preconditions does not hold.
Error precondition_error(const TaskNetwork& network, NodeId node, const Literal& literal);

}  // namespace segue::cdtn

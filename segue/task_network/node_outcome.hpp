// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task_network/environment.hpp>
#include <segue/task_network/task_network.hpp>

#include <memory>
#include <string>
#include <vector>

namespace segue::task_network {

/// The meaning of a node's end, in sequential and concurrent runs alike.
struct NodeOutcome {
  OutcomeId outcome = kSuccess;
  bool as_declared = false;        ///< the declared effects happened
  std::vector<Literal> effects;    ///< otherwise, the observed ones
  std::unique_ptr<Error> failure;  ///< set if the mission cannot go on
};

/// Compares a report with the node's declaration. An effect that was not declared is a failure, unless the
/// node is `uncertain` (it may set other values of the same facts) or `opaque` (it may change anything). So
/// are an abort without a handler and an outcome without a successor.
NodeOutcome judge(const TaskNetwork& network, NodeId node, const Report* report);

/// The failure of a node that needs more units than there can be: `there` of what it claims.
Error shortage_error(const TaskNetwork& network, NodeId node, const Claim& claim, std::uint64_t there);

/// The failure of a node because of a precondition that is false.
Error precondition_error(const TaskNetwork& network, NodeId node, const Literal& literal);

}  // namespace segue::task_network

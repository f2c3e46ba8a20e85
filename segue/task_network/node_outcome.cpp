// SPDX-License-Identifier: Apache-2.0
#include "node_outcome.hpp"

#include <segue/base/shortage.hpp>
#include <segue/base/text.hpp>

#include <algorithm>

namespace segue::task_network {

namespace {

Error undeclared(const TaskNetwork& network, NodeId node, const std::string& what) {
  return fail(
      ErrorCode::HookFailed,
      what + "; declare it, or mark the node as uncertain or opaque, since the order relies on declarations",
      network.label(node));
}

/// Every observed effect must be declared and, unless the node is uncertain, have the declared value; none
/// may be missing.
std::optional<Error> check_effects(const TaskNetwork& network, NodeId node, bool expected,
                                   const std::vector<Literal>& observed) {
  const NodeRecord& entry = network[node];
  if (entry.opaque) return std::nullopt;
  const auto accesses = network.accesses(node);
  for (const Literal& literal : observed) {
    const auto access = std::ranges::find_if(
        accesses, [&](const Access& one) { return one.writes && one.fact == literal.fact; });
    const bool foreseen =
        access != accesses.end() && (entry.uncertain || (expected && access->value == literal.value));
    if (!foreseen)
      return undeclared(network, node, "its effect " + network.facts.text(literal) + " is not declared");
  }
  if (entry.uncertain || !expected) return std::nullopt;
  for (const Access& access : accesses) {
    if (access.writes && std::ranges::find(observed, access.fact, &Literal::fact) == observed.end()) {
      return undeclared(
          network, node,
          "its effect " + network.facts.text(Literal{access.fact, access.value}) + " did not come about");
    }
  }
  return std::nullopt;
}

std::optional<Error> check_outcome(const TaskNetwork& network, NodeId node, const Report* report) {
  const NodeRecord& entry = network[node];
  const OutcomeId outcome = report == nullptr ? kSuccess : report->outcome;
  if (outcome == kPreempted) return fail(ErrorCode::Cancelled, "was preempted", network.label(node));
  if (outcome == kAborted) {
    if (entry.branches && entry.handles_abort) return std::nullopt;
    return fail(ErrorCode::HookFailed, report->error.empty() ? "aborted" : report->error,
                network.label(node));
  }
  if (outcome == entry.expected || entry.branches) return std::nullopt;
  return fail(ErrorCode::HookFailed,
              "ended with outcome " + quote(network.outcomes.name(static_cast<std::uint32_t>(outcome))) +
                  ", which leads nowhere",
              network.label(node));
}

}  // namespace

NodeOutcome judge(const TaskNetwork& network, NodeId node, const Report* report) {
  NodeOutcome result;
  result.outcome = report == nullptr ? kSuccess : report->outcome;
  const bool expected = result.outcome == network[node].expected;
  if (report == nullptr && expected) {
    result.as_declared = true;
    return result;
  }
  auto failure = check_outcome(network, node, report);
  if (report != nullptr && report->effects) {
    result.effects = *report->effects;
    if (!failure) failure = check_effects(network, node, expected, result.effects);
  } else {
    result.as_declared = expected;
  }
  if (!failure) return result;
  result.failure = std::make_unique<Error>(std::move(*failure));
  if (network[node].kind != ActionClass::Irreversible) {  // it changes nothing but the plan's own state
    result.as_declared = false;
    result.effects.clear();
  }
  return result;
}

Error shortage_error(const TaskNetwork& network, NodeId node, const Claim& claim, std::uint64_t there) {
  return fail(ErrorCode::ResourceExhausted,
              shortage_text(network.resources.name(claim.resource), claim.count, there), network.label(node));
}

Error precondition_error(const TaskNetwork& network, NodeId node, const Literal& literal) {
  return fail(ErrorCode::InvalidState, "its precondition " + network.facts.text(literal) + " does not hold",
              network.label(node));
}

}  // namespace segue::task_network

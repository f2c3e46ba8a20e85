// SPDX-License-Identifier: Apache-2.0
#include "concurrent_engine_implementation.hpp"

#include <segue/base/text.hpp>

namespace segue::task_network {

namespace {

std::string amount(const TaskNetwork& network, const Claim& claim, const ResourcePool& pool) {
  return std::to_string(claim.count) + " of " + quote(network.resources.name(claim.resource)) + " (" +
         std::to_string(pool.total(claim.resource)) + " in total, " +
         std::to_string(pool.free(claim.resource)) + " free)";
}

}  // namespace

std::string ConcurrentEngine::Implementation::waits_for(NodeId node) const {
  const State& state = at(node);
  const std::string name = quote(network_.label(node));
  if (state.active) return name + " was cancelled and has not ended";
  if (state.phase == Phase::Queued) {
    const Claim* claim = pool_.obstacle(network_.claims(node));
    if (claim != nullptr) return name + " waits for " + amount(network_, *claim, pool_);
    return name + " waits for earlier nodes at a resource";
  }
  for (const Dependency& dependency : order_.before(node)) {
    const State& from = at(dependency.from);
    const bool resource = dependency.reason() == Reason::Resource;
    if (resource ? from.began : from.passed) continue;
    return name + " waits for " + quote(network_.label(dependency.from)) + " (" +
           std::string(to_string(dependency.reason())) + ": " + subject_text(network_, dependency) + ")";
  }
  return name + " waits for the nodes before it";
}

/// Names the lowest nodes that cannot go on, and the nodes or resources they wait for.
Error ConcurrentEngine::Implementation::stall_error() const {
  constexpr int kNamed = 5;
  std::string text;
  int named = 0;
  if (!running_.empty()) {
    return fail(ErrorCode::DeadlineExceeded, waits_for(running_.front()), network_.label(running_.front()));
  }
  for (std::uint32_t i = prefix_; i < states_.size() && named < kNamed; ++i) {
    if (states_[i].passed) continue;
    text += (named++ == 0 ? "" : "; ") + waits_for(NodeId{i});
  }
  return fail(ErrorCode::ResourceExhausted, "no node can go on: " + text,
              prefix_ < states_.size() ? network_.label(NodeId{prefix_}) : "");
}

}  // namespace segue::task_network

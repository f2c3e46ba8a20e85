// SPDX-License-Identifier: Apache-2.0
#include "waits.hpp"

#include <algorithm>
#include <array>

namespace segue::cdtn {

std::string_view to_string(Wait::Kind kind) {
  static constexpr std::array<std::string_view, 4> kNames{"data", "condition", "world", "resource"};
  return kNames[static_cast<std::size_t>(kind)];
}

namespace {

Wait::Kind kind_of(Reason reason) {
  switch (reason) {
    case Reason::Data:
      return Wait::Kind::Data;
    case Reason::Condition:
      return Wait::Kind::Condition;
    case Reason::Resource:
      return Wait::Kind::Resource;
    default:
      return Wait::Kind::World;
  }
}

}  // namespace

WaitFinder::WaitFinder(const Network& network, const Order& order, const RunResult& result)
    : network_(network), order_(order), result_(result), uses_(network.resources.size()) {
  for (std::uint32_t i = 0; i < result.nodes.size(); ++i) {
    if (result.nodes[i].attempts > 0) add_use(NodeId{i}, result.nodes[i].ended);
  }
  for (const WastedRun& run : result.wasted)
    add_use(run.node, run.ended);
  for (std::vector<Use>& uses : uses_)
    std::ranges::stable_sort(uses, {}, &Use::ended);
}

void WaitFinder::add_use(NodeId node, TimePoint ended) {
  for (const Claim& claim : network_.claims(node))
    uses_[index(claim.resource)].push_back({ended, node});
}

/// When the dependency was met. Outputs are there when the run has ended; what holds back that they count
/// holds back whoever takes them too.
TimePoint WaitFinder::met(const Dependency& dependency) const {
  const NodeResult& from = result_.nodes[index(dependency.from)];
  if (dependency.reason() == Reason::Resource) return from.started;
  return dependency.reason() == Reason::Data ? from.ended : from.committed;
}

/// The node's resource that somebody else gave back last before it started.
Wait WaitFinder::wait_for_resource(NodeId node, TimePoint ready) const {
  const TimePoint started = result_.nodes[index(node)].started;
  const auto claims = network_.claims(node);
  Wait wait{Wait::Kind::Resource, NodeId{kNone}, network_.resources.name(claims.front().resource), ready,
            started};
  TimePoint latest{};
  for (const Claim& claim : claims) {
    const std::vector<Use>& uses = uses_[index(claim.resource)];
    auto use = std::ranges::upper_bound(uses, started, {}, &Use::ended);
    while (use != uses.begin() && std::prev(use)->node == node)
      --use;
    if (use == uses.begin() || std::prev(use)->ended <= latest) continue;
    latest = std::prev(use)->ended;
    wait.node = std::prev(use)->node;
    wait.subject = network_.resources.name(claim.resource);
  }
  return wait;
}

std::vector<Wait> WaitFinder::of(NodeId node) const {
  const NodeResult& own = result_.nodes[index(node)];
  std::vector<Wait> waits;
  if (own.attempts == 0) return waits;
  TimePoint ready{};
  for (const Dependency& dependency : order_.before(node)) {
    const TimePoint until = met(dependency);
    if (until > own.started || until == TimePoint{})
      continue;  // that held back what comes of it, not the start
    waits.push_back(
        {kind_of(dependency.reason()), dependency.from, subject_text(network_, dependency), {}, until});
    ready = std::max(ready, until);
  }
  std::ranges::stable_sort(waits, {}, &Wait::until);
  TimePoint from{};
  for (Wait& wait : waits)
    wait.from = std::exchange(from, wait.until);
  std::erase_if(waits, [](const Wait& wait) { return wait.from == wait.until; });
  if (own.started > ready && !network_.claims(node).empty()) waits.push_back(wait_for_resource(node, ready));
  return waits;
}

bool WaitFinder::ran_ahead(NodeId node) const {
  const NodeResult& own = result_.nodes[index(node)];
  if (own.attempts == 0) return false;
  return std::ranges::any_of(order_.before(node), [&](const Dependency& dependency) {
    return dependency.reason() != Reason::Resource && met(dependency) > own.started;
  });
}

std::vector<NodeId> critical_chain(const RunResult& result, const WaitFinder& waits) {
  std::vector<NodeId> chain;
  const auto last = std::ranges::max_element(result.nodes, {}, &NodeResult::committed);
  if (last == result.nodes.end() || last->committed == TimePoint{}) return chain;
  NodeId node = NodeId(static_cast<std::uint32_t>(last - result.nodes.begin()));
  while (index(node) != kNone && chain.size() <= result.nodes.size()) {
    chain.push_back(node);
    const auto own = waits.of(node);
    node = own.empty() ? NodeId{kNone} : own.back().node;
  }
  std::ranges::reverse(chain);
  return chain;
}

}  // namespace segue::cdtn

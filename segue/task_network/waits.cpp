// SPDX-License-Identifier: Apache-2.0
#include "waits.hpp"

#include <algorithm>
#include <array>

namespace segue::task_network {

std::string_view to_string(Wait::Kind kind) {
  static constexpr std::array<std::string_view, 5> kNames{"data", "condition", "world", "resource", "turn"};
  return kNames[static_cast<std::size_t>(kind)];
}

std::string to_string(const Wait& wait, const std::string& node) {
  std::string text(to_string(wait.kind));
  if (!wait.subject.empty()) text += ' ' + wait.subject;
  if (!node.empty()) text += (wait.kind == Wait::Kind::Turn ? " after " : " of ") + node;
  return text;
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
    case Reason::Place:
      return Wait::Kind::Turn;
    case Reason::Fact:
      break;
  }
  return Wait::Kind::World;
}

}  // namespace

WaitFinder::WaitFinder(const TaskNetwork& network, const Order& order, const RunResult& result)
    : network_(network), order_(order), result_(result), uses_(network.resources.size()) {
  for (std::uint32_t i = 0; i < result.nodes.size(); ++i) {
    if (result.nodes[i].attempts > 0) add_use(NodeId{i}, result.nodes[i].ended);
  }
  for (const WastedRun& run : result.wasted)
    add_use(run.node, run.ended);
  std::ranges::stable_sort(ends_, {}, &Use::ended);
  for (std::vector<Use>& uses : uses_)
    std::ranges::stable_sort(uses, {}, &Use::ended);
}

void WaitFinder::add_use(NodeId node, TimePoint ended) {
  ends_.push_back({ended, node});
  for (const Claim& claim : network_.claims(node))
    uses_[index(claim.resource)].push_back({ended, node});
}

/// The time at which the dependency was met. Outputs exist when the run has ended; if they cannot count yet,
/// that holds back the commit of their consumers too.
TimePoint WaitFinder::met(const Dependency& dependency) const {
  const NodeResult& from = result_.nodes[index(dependency.from)];
  if (dependency.reason() == Reason::Resource) return from.started;
  return dependency.reason() == Reason::Data ? from.ended : from.committed;
}

/// The last use by another node that ended no later than `started`.
const WaitFinder::Use* WaitFinder::last_before(const std::vector<Use>& uses, NodeId node, TimePoint started) {
  auto use = std::ranges::upper_bound(uses, started, {}, &Use::ended);
  while (use != uses.begin() && std::prev(use)->node == node)
    --use;
  return use == uses.begin() ? nullptr : &*std::prev(use);
}

/// Adds the wait for the resource that was released last before the node started.
void WaitFinder::add_resource(std::vector<Wait>& waits, NodeId node, TimePoint ready) const {
  const Use* last = nullptr;
  ResourceId resource{};
  for (const Claim& claim : network_.claims(node)) {
    const Use* use = last_before(uses_[index(claim.resource)], node, result_.nodes[index(node)].started);
    if (use == nullptr || use->ended <= ready + result_.own_time ||
        (last != nullptr && use->ended <= last->ended))
      continue;
    last = use;
    resource = claim.resource;
  }
  if (last == nullptr) return;
  waits.push_back({Wait::Kind::Resource, last->node, network_.resources.name(resource), ready, last->ended});
}

/// Nothing else can have kept it waiting longer.
void WaitFinder::add_limited(std::vector<Wait>& waits, NodeId node) const {
  for (const UnitWait& wait : result_.unit_waits) {
    if (wait.node == node)
      waits.push_back({Wait::Kind::Resource, NodeId{kNone}, network_.resources.name(wait.resource), wait.from,
                       wait.until});
  }
}

void WaitFinder::add_turn(std::vector<Wait>& waits, NodeId node, TimePoint ready) const {
  const TimePoint started = result_.nodes[index(node)].started;
  const Use* last = last_before(ends_, node, started);
  if (last != nullptr && last->ended > ready + result_.own_time)
    waits.push_back({Wait::Kind::Turn, last->node, {}, ready, last->ended});
}

/// One that failed is shown as others are.
bool WaitFinder::is_structural(NodeId node) const {
  return index(node) != kNone && network_[node].structural &&
         result_.nodes[index(node)].status != NodeStatus::Failed;
}

std::vector<Wait> WaitFinder::of(NodeId node) const {
  std::vector<Wait> waits = direct(node);
  for (Wait& wait : waits) {
    while (is_structural(wait.node)) {
      const auto before = direct(wait.node);
      wait.node = before.empty() ? NodeId{kNone} : before.back().node;
      if (before.empty() || (wait.kind == Wait::Kind::Data && before.back().kind == wait.kind)) continue;
      wait.kind = before.back().kind;
      wait.subject = before.back().subject;
    }
  }
  return waits;
}

std::vector<Wait> WaitFinder::direct(NodeId node) const {
  const NodeResult& own = result_.nodes[index(node)];
  std::vector<Wait> waits;
  if (own.attempts == 0) return waits;
  TimePoint ready{};
  for (const Dependency& dependency : order_.before(node)) {
    const TimePoint until = met(dependency);
    if (until > own.started || until == TimePoint{}) continue;  // it delayed the commit, not the start
    const bool place = dependency.reason() == Reason::Place;
    waits.push_back({kind_of(dependency.reason()),
                     dependency.from,
                     place ? std::string() : subject_text(network_, dependency),
                     {},
                     until});
    ready = std::max(ready, until);
  }
  std::ranges::stable_sort(waits, {}, &Wait::until);
  TimePoint from{};
  for (Wait& wait : waits)
    wait.from = std::exchange(from, wait.until);
  std::erase_if(waits, [&](const Wait& wait) { return wait.until - wait.from <= result_.own_time; });
  add_resource(waits, node, ready);
  add_limited(waits, node);
  if (!waits.empty()) ready = waits.back().until;
  add_turn(waits, node, ready);
  return waits;
}

std::optional<Duration> WaitFinder::time_ahead(NodeId node) const {
  const NodeResult& own = result_.nodes[index(node)];
  if (own.attempts == 0) return std::nullopt;
  TimePoint certain = own.started;
  for (const Dependency& dependency : order_.before(node)) {
    if (dependency.reason() != Reason::Resource) certain = std::max(certain, met(dependency));
  }
  return certain == own.started ? std::nullopt : std::optional(std::min(certain, own.ended) - own.started);
}

std::vector<NodeId> WaitFinder::critical_chain() const {
  std::vector<NodeId> chain;
  const auto last = std::ranges::max_element(result_.nodes, {}, &NodeResult::committed);
  if (last == result_.nodes.end() || last->committed == TimePoint{}) return chain;
  NodeId node = NodeId(static_cast<std::uint32_t>(last - result_.nodes.begin()));
  for (std::size_t steps = 0; index(node) != kNone && steps <= result_.nodes.size(); ++steps) {
    if (!is_structural(node)) chain.push_back(node);
    const auto own = of(node);
    node = own.empty() ? NodeId{kNone} : own.back().node;
  }
  std::ranges::reverse(chain);
  return chain;
}

}  // namespace segue::task_network

// SPDX-License-Identifier: Apache-2.0
#include "critical_path.hpp"

#include <segue/base/time_after.hpp>

#include <algorithm>

namespace segue::task_network {

namespace {

/// The earliest times at which a node can start, end and commit, and the node that decides them.
struct Times {
  Duration start{};
  Duration end{};
  Duration commit{};
  std::uint32_t cause = kNone;
};

class LongestPath {
 public:
  LongestPath(const TaskNetwork& network, const Order& order, const RunResult* result)
      : network_(network), order_(order), result_(result), times_(network.size()) {
    for (std::uint32_t i = 0; i < network.size(); ++i)
      visit(NodeId{i});
  }

  [[nodiscard]] CriticalPath path() const {
    CriticalPath path;
    const auto last = std::ranges::max_element(times_, {}, &Times::commit);
    if (last == times_.end()) return path;
    path.length = last->commit;
    for (auto i = static_cast<std::uint32_t>(last - times_.begin()); i != kNone; i = times_[i].cause)
      path.nodes.push_back(NodeId{i});
    std::ranges::reverse(path.nodes);
    return path;
  }

 private:
  [[nodiscard]] bool skipped(NodeId node) const {
    return result_ != nullptr && result_->nodes[index(node)].status != NodeStatus::Done;
  }
  [[nodiscard]] Duration duration(NodeId node) const {
    if (skipped(node)) return {};
    if (result_ == nullptr) return network_[node].duration;
    return result_->nodes[index(node)].ended - result_->nodes[index(node)].started;
  }

  [[nodiscard]] NodeId planned_after(NodeId node) const {
    return result_ == nullptr || skipped(node) ? NodeId{kNone} : result_->nodes[index(node)].planned_after;
  }

  /// Whether the dependency delays the start, or only the commit.
  [[nodiscard]] bool holds_start(const Dependency& dependency) const {
    const ActionClass kind = network_[dependency.to].kind;
    if (kind == ActionClass::Irreversible || skipped(dependency.to)) return true;
    switch (dependency.reason()) {
      case Reason::Fact:
        return kind == ActionClass::Sensing;
      case Reason::Condition:
        return false;
      default:
        return true;
    }
  }

  void visit(NodeId node) {
    Times& own = times_[index(node)];
    Duration gate{};
    std::uint32_t gate_cause = kNone;
    const auto later = [](Duration& time, std::uint32_t& cause, Duration other, NodeId from) {
      if (other <= time) return;
      time = other;
      cause = index(from);
    };
    const bool firm = network_[node].kind == ActionClass::Irreversible;
    for (const Dependency& dependency : order_.before(node)) {
      const Times& from = times_[index(dependency.from)];
      const bool ahead = dependency.reason() == Reason::Data && !firm;
      if (dependency.reason() == Reason::Resource) {
        later(own.start, own.cause, from.start, dependency.from);
        continue;
      }
      if (holds_start(dependency))
        later(own.start, own.cause, ahead ? from.end : from.commit, dependency.from);
      later(gate, gate_cause, from.commit, dependency.from);
    }
    if (const NodeId before = planned_after(node); index(before) != kNone)
      later(own.start, own.cause, times_[index(before)].commit, before);
    own.end = own.commit = sum_of_durations(own.start, duration(node));
    later(own.commit, own.cause, gate, NodeId{gate_cause});
  }

  const TaskNetwork& network_;
  const Order& order_;
  const RunResult* result_;
  std::vector<Times> times_;
};

}  // namespace

CriticalPath critical_path(const TaskNetwork& network, const Order& order) {
  return LongestPath(network, order, nullptr).path();
}

CriticalPath critical_path(const TaskNetwork& network, const Order& order, const RunResult& result) {
  return LongestPath(network, order, &result).path();
}

Duration busiest_resource(const TaskNetwork& network, const RunResult& result) {
  std::vector<Duration> used(network.resources.size());
  for (std::uint32_t i = 0; i < result.nodes.size(); ++i) {
    const NodeResult& node = result.nodes[i];
    if (node.status != NodeStatus::Done || node.attempts == 0) continue;
    for (const Claim& claim : network.claims(NodeId{i})) {
      if (claim.op == ResourceOp::Block && claim.group == kNone)
        used[index(claim.resource)] += (node.ended - node.started) * claim.count;
    }
  }
  Duration longest{};
  for (std::uint32_t i = 0; i < used.size(); ++i) {
    const ResourceRecord& resource = network.resources[ResourceId{i}];
    const bool fixed = !resource.varies && !resource.lent && resource.count > 0;
    if (fixed) longest = std::max(longest, used[i] / resource.count);
  }
  return longest;
}

std::vector<std::uint64_t> critical_path_priorities(const TaskNetwork& network, const Order& order) {
  std::vector<Duration> to_end(network.size());
  Duration longest{};
  for (std::uint32_t i = network.size(); i-- > 0;) {
    to_end[i] = sum_of_durations(to_end[i], network[NodeId{i}].duration);
    longest = std::max(longest, to_end[i]);
    for (const Dependency& dependency : order.before(NodeId{i})) {
      const std::uint32_t from = index(dependency.from);
      if (dependency.reason() != Reason::Resource) to_end[from] = std::max(to_end[from], to_end[i]);
    }
  }
  std::vector<std::uint64_t> priorities;
  for (const Duration length : to_end)
    priorities.push_back(static_cast<std::uint64_t>((longest - length).count()));
  return priorities;
}

}  // namespace segue::task_network

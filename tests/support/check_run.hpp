// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task_network/acts_ahead.hpp>
#include <segue/task_network/run_result.hpp>
#include <segue/task_network/task_network.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <string>
#include <vector>

/// Checks from results and log that a concurrent run is equivalent to the sequential one. For tests only.
namespace segue::task_network {

/// Whether the run of the node that was last counts: a node that is refused in the end has none, whatever ran
/// before.
inline bool last_run_counts(const RunLog& log, NodeId node) {
  bool counts = false;
  for (const LogEntry& entry : log) {
    if (entry.node != node) continue;
    if (entry.kind == LogKind::End) counts = true;
    if (entry.kind == LogKind::Discard) counts = false;
  }
  return counts;
}

/// Whether something remains of the node in a concurrent run, also of one that has been preempted.
inline bool has_acted(const TaskNetwork& network, const RunResult& run, NodeId node) {
  const NodeResult& result = run.nodes[index(node)];
  if (!acts(network, node) || result.attempts == 0) return false;
  if (network[node].kind == ActionClass::Irreversible) return true;
  return result.status == NodeStatus::Done && last_run_counts(run.log, node) &&
         (result.outcome == network[node].expected || network[node].uncertain);
}

class RunCheck {
 public:
  /// `beside`: whether the first node need not wait for a failure of the second.
  RunCheck(
      const TaskNetwork& network, const RunResult& sequential, const RunResult& concurrent, bool strict,
      std::function<bool(NodeId, NodeId)> beside = [](NodeId, NodeId) { return false; })
      : network_(network),
        sequential_(sequential),
        concurrent_(concurrent),
        strict_(strict),
        beside_(std::move(beside)) {}

  /// The first difference, or "".
  std::string difference() {
    for (const auto check :
         {&RunCheck::end, &RunCheck::nodes, &RunCheck::world, &RunCheck::grants, &RunCheck::groups,
          &RunCheck::resource_order, &RunCheck::failure, &RunCheck::ahead}) {
      if (std::string text = (this->*check)(); !text.empty()) return text;
    }
    return {};
  }

  /// Reports if it took longer than the nodes in sequence, else "". Requires that each node takes the same
  /// time in both runs, that cancelled nodes end at once, and that priorities follow program order. A failed
  /// run is only checked if strict: nodes behind the failing one take time that the sequential run does not
  /// need.
  std::string slower() {
    if ((sequential_.failed && !strict_) || concurrent_.makespan <= sequential_.makespan) return {};
    const auto seconds = [](Duration time) { return time / std::chrono::seconds(1); };
    return fmt::format("took {} s instead of {} s", seconds(concurrent_.makespan),
                       seconds(sequential_.makespan));
  }

 private:
  static std::string failure_text(const RunResult& result) {
    return result.failed ? fmt::format("n{}: {}", index(*result.failed), to_string(*result.error)) : "none";
  }

  std::string end() {
    const bool same = sequential_.failed == concurrent_.failed &&
                      (!sequential_.error || sequential_.error->message == concurrent_.error->message);
    if (same) return {};
    return fmt::format("failure {} instead of {}", failure_text(concurrent_), failure_text(sequential_));
  }

  [[nodiscard]] std::uint32_t compared() const {
    return sequential_.failed ? index(*sequential_.failed) : network_.size();
  }

  std::string nodes() {
    for (std::uint32_t i = 0; i < compared(); ++i) {
      const NodeResult& a = sequential_.nodes[i];
      const NodeResult& b = concurrent_.nodes[i];
      if (a.status != b.status) {
        return fmt::format("n{} has status {} instead of {}", i, static_cast<int>(b.status),
                           static_cast<int>(a.status));
      }
      if (a.status != NodeStatus::Done) continue;
      if (a.outcome != b.outcome) return fmt::format("n{} has another outcome", i);
      const auto& first = sequential_.outputs[i];
      const auto& second = concurrent_.outputs[i];
      if ((first == nullptr) != (second == nullptr) || (first && !(*first == *second)))
        return fmt::format("n{} has read other values", i);
    }
    return {};
  }

  /// After a failure, later nodes may have acted already, except behind irreversible ones.
  std::string world() {
    if (sequential_.failed && !strict_) return {};
    if (!(sequential_.world == concurrent_.world)) {
      return fmt::format("world {} instead of {}", fmt::join(concurrent_.world.texts(network_.facts), " "),
                         fmt::join(sequential_.world.texts(network_.facts), " "));
    }
    if (sequential_.units != concurrent_.units) return "other units are left";
    return {};
  }

  /// At every moment, resources of a constant number of units are not overused.
  std::string grants() {
    std::vector<std::uint32_t> used(network_.resources.size(), 0);
    for (const LogEntry& entry : concurrent_.log) {
      if (entry.kind != LogKind::Start && entry.kind != LogKind::End) continue;
      for (const Claim& claim : network_.claims(entry.node)) {
        const ResourceRecord& resource = network_.resources[claim.resource];
        if (claim.op != ResourceOp::Block || resource.varies) continue;
        std::uint32_t& units = used[index(claim.resource)];
        units = entry.kind == LogKind::Start ? units + claim.count : units - claim.count;
        if (units > resource.count) {
          return fmt::format("n{} got '{}', which others use", index(entry.node),
                             network_.resources.name(claim.resource));
        }
      }
    }
    return {};
  }

  /// Whether some node creates or removes units.
  bool changes(ResourceId resource) {
    bool any = false;
    for_each_claim([&](NodeId, const Claim& claim) {
      const bool fixed =
          claim.op == ResourceOp::Block || claim.op == ResourceOp::Exists || claim.op == ResourceOp::Release;
      any = any || (claim.resource == resource && !fixed);
    });
    return any;
  }

  /// From the first start to the last end of its members nobody else has units of a lock.
  std::string groups() {
    struct Held {
      TimePoint first;
      TimePoint last;
    };
    std::map<std::uint32_t, Held> held;
    for_each_claim([&](NodeId node, const Claim& claim) {
      if (claim.group == kNone || changes(claim.resource)) return;
      const NodeResult& result = concurrent_.nodes[index(node)];
      Held& times = held.emplace(claim.group, Held{result.started, result.ended}).first->second;
      times = {std::min(times.first, result.started), std::max(times.last, result.ended)};
    });
    std::string text;
    const auto check = [&](ResourceId resource, std::uint32_t count, const Held& own, std::uint32_t itself) {
      for (const auto& [group, times] : held) {
        const GroupLock& lock = network_.groups()[group];
        const bool overlap = own.first < times.last && times.first < own.last;
        if (group != itself && lock.resource == resource && overlap &&
            count + lock.count > network_.resources[resource].count)
          text = fmt::format("a group's lock of {} was not kept", network_.resources.name(resource));
      }
    };
    for_each_claim([&](NodeId node, const Claim& claim) {
      const NodeResult& result = concurrent_.nodes[index(node)];
      if (claim.op == ResourceOp::Block && claim.group == kNone)
        check(claim.resource, claim.count, {result.started, result.ended}, kNone);
    });
    for (const auto& [group, times] : held)
      check(network_.groups()[group].resource, network_.groups()[group].count, times, group);
    return text;
  }

  /// Irreversible nodes start in program order at each resource.
  std::string resource_order() {
    std::map<std::uint32_t, NodeId> last;
    std::string text;
    for_each_claim([&](NodeId node, const Claim& claim) {
      const ResourceRecord& resource = network_.resources[claim.resource];
      if (network_[node].kind != ActionClass::Irreversible || claim.op == ResourceOp::Exists ||
          resource.commutes)
        return;
      const auto [place, first] = last.emplace(index(claim.resource), node);
      if (!first && concurrent_.nodes[index(node)].started < concurrent_.nodes[index(place->second)].started)
        text = fmt::format("n{} overtook n{}", index(node), index(place->second));
      place->second = node;
    });
    return text;
  }

  /// No node behind a failed one starts.
  std::string failure() {
    if (!concurrent_.failed) return {};
    bool failed = false;
    for (const LogEntry& entry : concurrent_.log) {
      if (entry.node == *concurrent_.failed && entry.kind == LogKind::Commit) failed = true;
      if (failed && entry.kind == LogKind::Start && entry.node > *concurrent_.failed)
        return fmt::format("n{} starts although n{} has failed", index(entry.node),
                           index(*concurrent_.failed));
    }
    return {};
  }

  /// What acts although an earlier node fails is what the order permits; in strict runs nothing.
  std::string ahead() {
    if (!concurrent_.failed) return {};
    const auto pairs = acts_ahead(network_, derive_order(network_), WholeNetwork(network_));
    for (std::uint32_t i = index(*concurrent_.failed) + 1; i < concurrent_.nodes.size(); ++i) {
      if (!has_acted(network_, concurrent_, NodeId{i}) || beside_(NodeId{i}, *concurrent_.failed)) continue;
      const ActsAhead pair{NodeId{i}, *concurrent_.failed};
      if (strict_ || std::ranges::find(pairs, pair) == pairs.end())
        return fmt::format("n{} has acted although n{} failed", i, index(*concurrent_.failed));
    }
    return {};
  }

  template <class Visit>
  void for_each_claim(Visit&& visit) {
    for (std::uint32_t i = 0; i < compared(); ++i) {
      if (concurrent_.nodes[i].status != NodeStatus::Done || concurrent_.nodes[i].attempts == 0) continue;
      for (const Claim& claim : network_.claims(NodeId{i}))
        visit(NodeId{i}, claim);
    }
  }

  const TaskNetwork& network_;
  const RunResult& sequential_;
  const RunResult& concurrent_;
  const bool strict_;
  const std::function<bool(NodeId, NodeId)> beside_;
};

}  // namespace segue::task_network

// SPDX-License-Identifier: Apache-2.0
#include "run_report.hpp"

#include <array>

namespace segue::task_network {

using type::Value;
using type::ValueMap;

namespace {

double in_seconds(TimePoint time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}
double in_seconds(Duration duration) {
  return std::chrono::duration<double>(duration).count();
}

}  // namespace

std::string_view to_string(NodeStatus status) {
  static constexpr std::array<std::string_view, 5> kNames{"not reached", "done", "skipped", "failed",
                                                          "preempted"};
  return kNames[static_cast<std::size_t>(status)];
}

std::string_view outcome_of(const RunResult& result) {
  return result.done() ? "done" : result.stopped ? "stopped" : "failed";
}

std::vector<NodeId> listed_nodes(const TaskNetwork& network, const RunResult& result, ListedNodes which) {
  std::vector<NodeId> listed;
  for (std::uint32_t i = 0; i < result.nodes.size(); ++i) {
    const NodeResult& own = result.nodes[i];
    const bool failed = own.status == NodeStatus::Failed;
    const bool wanted = which == ListedNodes::All || own.attempts > 0;
    if (failed || (wanted && !network[NodeId{i}].structural)) listed.push_back(NodeId{i});
  }
  return listed;
}

namespace {

Value node_value(const TaskNetwork& network, const RunResult& result, const WaitFinder& finder, NodeId node) {
  const NodeResult& own = result.nodes[index(node)];
  ValueMap entry;
  entry.set("name", network.name_of(node));
  entry.set("iteration", static_cast<std::uint64_t>(network[node].iteration));
  entry.set("start_s", in_seconds(own.started));
  entry.set("end_s", in_seconds(own.ended));
  entry.set("commit_s", in_seconds(own.committed));
  entry.set("status", to_string(own.status));
  const bool ended = own.status != NodeStatus::NotReached && own.status != NodeStatus::Skipped;
  entry.set("outcome", ended ? network.outcomes.name(static_cast<std::uint32_t>(own.outcome)) : "");
  entry.set("pia", network[node].kind == ActionClass::Irreversible);
  entry.set("runs", static_cast<std::uint64_t>(own.attempts));
  Value::List resources;
  for (const Claim& claim : network.claims(node)) {
    resources.push_back(Value::map({{"name", network.resources.name(claim.resource)},
                                    {"op", kResourceOps[static_cast<std::size_t>(claim.op)]},
                                    {"count", static_cast<std::uint64_t>(claim.count)}}));
  }
  entry.set("resources", std::move(resources));
  Value::List waits;
  for (const Wait& wait : finder.of(node))
    waits.push_back(to_value(wait, index(wait.node) == kNone ? "" : network.label(wait.node)));
  entry.set("waited_for", std::move(waits));
  return entry;
}

}  // namespace

SpeculationSummary speculation_of(const TaskNetwork& network, const RunResult& result,
                                  const WaitFinder& waits) {
  SpeculationSummary speculation;
  for (std::uint32_t i = 0; i < result.nodes.size(); ++i) {
    const NodeId node{i};
    if (network[node].structural || result.nodes[i].status != NodeStatus::Done) continue;
    if (const auto ahead = waits.time_ahead(node)) {
      ++speculation.used;
      speculation.ahead += *ahead;
    }
  }
  for (const WastedRun& run : result.wasted) {
    if (network[run.node].structural) continue;
    ++speculation.discarded;
    speculation.discarded_time += run.ended - run.started;
  }
  return speculation;
}

Value to_value(const Wait& wait, const std::string& node) {
  ValueMap entry;
  entry.set("kind", to_string(wait.kind));
  if (!node.empty()) entry.set("node", node);
  entry.set("subject", wait.subject);
  entry.set("from_s", in_seconds(wait.from));
  entry.set("until_s", in_seconds(wait.until));
  return entry;
}

Value to_value(const TaskNetwork& network, const RunResult& result, const WaitFinder& waits,
               std::span<const NodeId> listed, const RunSummary& summary) {
  ValueMap root;
  root.set("name", network.name);
  root.set("outcome", outcome_of(result));
  if (result.error) root.set("error", to_string(*result.error));
  root.set("makespan_s", in_seconds(result.makespan));
  root.set("sequential_s", in_seconds(summary.sequential));
  root.set("critical_path_s", in_seconds(summary.critical_path));
  root.set("shortest_s", in_seconds(summary.shortest));
  Value::List nodes;
  for (const NodeId node : listed)
    nodes.push_back(node_value(network, result, waits, node));
  root.set("nodes", std::move(nodes));
  Value::List world;
  for (const std::string& fact : result.world.texts(network.facts))
    world.emplace_back(fact);
  root.set("world", std::move(world));
  ValueMap units;
  for (std::uint32_t i = 0; i < result.units.size(); ++i) {
    if (network.resources[ResourceId{i}].lent) continue;
    units.set(network.resources.name(ResourceId{i}), static_cast<std::uint64_t>(result.units[i]));
  }
  root.set("units", std::move(units));
  const RunStatistics& statistics = result.statistics;
  const SpeculationSummary& speculation = summary.speculation;
  root.set("speculation", Value::map({{"ahead", statistics.speculative},
                                      {"ahead_s", in_seconds(speculation.ahead)},
                                      {"wasted", statistics.wasted},
                                      {"wasted_s", in_seconds(speculation.discarded_time)},
                                      {"recalled", statistics.preempted},
                                      {"repeated", statistics.repeated}}));
  root.set("engine_us_per_node", summary.engine_per_node.count());
  return root;
}

}  // namespace segue::task_network

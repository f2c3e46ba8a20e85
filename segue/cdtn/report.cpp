// SPDX-License-Identifier: Apache-2.0
#include "report.hpp"

#include <segue/cdtn/report_lanes.hpp>
#include <segue/type/json.hpp>

#include <algorithm>
#include <array>

namespace segue::cdtn {

using type::Value;
using type::ValueMap;

std::string_view to_string(Wait::Kind kind) {
  static constexpr std::array<std::string_view, 4> kNames{"data", "condition", "world", "resource"};
  return kNames[static_cast<std::size_t>(kind)];
}

std::string_view to_string(NodeStatus status) {
  static constexpr std::array<std::string_view, 5> kNames{"not reached", "done", "skipped", "failed",
                                                          "preempted"};
  return kNames[static_cast<std::size_t>(status)];
}

namespace {

double in_seconds(TimePoint time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}
double in_seconds(Duration duration) {
  return std::chrono::duration<double>(duration).count();
}

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

/// When the dependency was met. Outputs are there when the run has ended; what holds back that they count
/// holds back whoever takes them too.
TimePoint met(const RunResult& result, const Dependency& dependency) {
  const NodeResult& from = result.nodes[index(dependency.from)];
  if (dependency.reason() == Reason::Resource) return from.started;
  return dependency.reason() == Reason::Data ? from.ended : from.committed;
}

/// The last one that used the same resource before: whose end let the node start.
NodeId holder_before(const Network& network, const RunResult& result, NodeId node, ResourceId resource) {
  NodeId last{kNone};
  TimePoint latest{};
  for (std::uint32_t i = 0; i < network.size(); ++i) {
    const NodeResult& other = result.nodes[i];
    if (NodeId{i} == node || other.attempts == 0 || other.ended > result.nodes[index(node)].started) continue;
    for (const Claim& claim : network.claims(NodeId{i})) {
      if (claim.resource != resource || other.ended < latest) continue;
      latest = other.ended;
      last = NodeId{i};
    }
  }
  return last;
}

}  // namespace

std::vector<Wait> waits_of(const Network& network, const Order& order, const RunResult& result, NodeId node) {
  const NodeResult& own = result.nodes[index(node)];
  std::vector<Wait> waits;
  if (own.attempts == 0) return waits;
  TimePoint ready{};
  for (const Dependency& dependency : order.before(node)) {
    const TimePoint until = met(result, dependency);
    if (until > own.started || until == TimePoint{})
      continue;  // that held back what comes of it, not the start
    waits.push_back(
        {kind_of(dependency.reason()), dependency.from, subject_text(network, dependency), {}, until});
    ready = std::max(ready, until);
  }
  std::ranges::stable_sort(waits, {}, &Wait::until);
  TimePoint from{};
  for (Wait& wait : waits)
    wait.from = std::exchange(from, wait.until);
  std::erase_if(waits, [](const Wait& wait) { return wait.from == wait.until; });
  if (own.started > ready && !network.claims(node).empty()) {
    const ResourceId resource = network.claims(node).front().resource;
    const NodeId holder = holder_before(network, result, node, resource);
    waits.push_back({Wait::Kind::Resource, holder, network.resources.name(resource), ready, own.started});
  }
  return waits;
}

std::vector<NodeId> critical_chain(const Network& network, const Order& order, const RunResult& result) {
  std::vector<NodeId> chain;
  const auto last = std::ranges::max_element(result.nodes, {}, &NodeResult::committed);
  if (last == result.nodes.end() || last->committed == TimePoint{}) return chain;
  NodeId node = NodeId(static_cast<std::uint32_t>(last - result.nodes.begin()));
  while (index(node) != kNone && chain.size() <= result.nodes.size()) {
    chain.push_back(node);
    const auto waits = waits_of(network, order, result, node);
    node = waits.empty() ? NodeId{kNone} : waits.back().node;
  }
  std::ranges::reverse(chain);
  return chain;
}

namespace {

Value node_value(const Network& network, const Order& order, const RunResult& result, NodeId node) {
  const NodeResult& own = result.nodes[index(node)];
  ValueMap entry;
  entry.set("name", network.name_of(node));
  entry.set("iteration", static_cast<std::uint64_t>(network[node].iteration));
  entry.set("start_s", in_seconds(own.started));
  entry.set("end_s", in_seconds(own.ended));
  entry.set("commit_s", in_seconds(own.committed));
  entry.set("status", to_string(own.status));
  entry.set("outcome", network.outcomes.name(static_cast<std::uint32_t>(own.outcome)));
  entry.set("pia", network[node].kind == NodeClass::Irreversible);
  entry.set("runs", static_cast<std::uint64_t>(own.attempts));
  Value::List resources;
  for (const Claim& claim : network.claims(node)) {
    resources.push_back(Value::map({{"name", network.resources.name(claim.resource)},
                                    {"op", kResourceOps[static_cast<std::size_t>(claim.op)]},
                                    {"count", static_cast<std::uint64_t>(claim.count)}}));
  }
  entry.set("resources", std::move(resources));
  Value::List waits;
  for (const Wait& wait : waits_of(network, order, result, node)) {
    ValueMap one;
    one.set("kind", to_string(wait.kind));
    if (index(wait.node) != kNone) one.set("node", network.label(wait.node));
    one.set("subject", wait.subject);
    one.set("from_s", in_seconds(wait.from));
    one.set("until_s", in_seconds(wait.until));
    waits.emplace_back(std::move(one));
  }
  entry.set("waited_for", std::move(waits));
  return entry;
}

}  // namespace

Value to_value(const Network& network, const Order& order, const RunResult& result,
               const RunSummary& summary) {
  ValueMap root;
  root.set("name", network.name);
  root.set("outcome", result.done() ? "done" : result.stopped ? "stopped" : "failed");
  if (result.error) root.set("error", to_string(*result.error));
  root.set("makespan_s", in_seconds(result.makespan));
  root.set("sequential_s", in_seconds(summary.sequential));
  root.set("critical_path_s", in_seconds(summary.critical_path));
  Value::List nodes;
  for (std::uint32_t i = 0; i < result.nodes.size(); ++i)
    nodes.push_back(node_value(network, order, result, NodeId{i}));
  root.set("nodes", std::move(nodes));
  Value::List world;
  for (const std::string& fact : result.world.texts(network.facts))
    world.emplace_back(fact);
  root.set("world", std::move(world));
  const RunStatistics& statistics = result.statistics;
  root.set("speculation", Value::map({{"ahead", statistics.ahead},
                                      {"wasted", statistics.wasted},
                                      {"repeated", statistics.repeated}}));
  root.set("engine_us_per_node", summary.engine_us_per_node);
  return root;
}

namespace {

Value trace_event(const std::string& name, double from, double until, int process, std::size_t row) {
  return Value::map({{"name", name},
                     {"ph", "X"},
                     {"ts", from * 1e6},
                     {"dur", (until - from) * 1e6},
                     {"pid", process},
                     {"tid", static_cast<std::uint64_t>(row)}});
}

Value trace_name(const char* what, const std::string& name, int process, std::size_t row) {
  return Value::map({{"name", what},
                     {"ph", "M"},
                     {"pid", process},
                     {"tid", static_cast<std::uint64_t>(row)},
                     {"args", Value::map({{"name", name}})}});
}

}  // namespace

std::string to_trace(const Network& network, const Order& order, const RunResult& result) {
  Value::List events;
  events.push_back(trace_name("process_name", "nodes", 1, 0));
  events.push_back(trace_name("process_name", "resources", 2, 0));
  for (const detail::Bar& bar : detail::lanes_of(network, result)) {
    Value event =
        trace_event(network.label(bar.node), in_seconds(bar.from), in_seconds(bar.until), 1, bar.lane);
    ValueMap details;
    details.set("wasted", bar.wasted);
    for (const Wait& wait : waits_of(network, order, result, bar.node))
      details.set(std::string(to_string(wait.kind)), wait.subject);
    event.as_map().set("args", std::move(details));
    events.push_back(std::move(event));
  }
  for (std::uint32_t i = 0; i < network.resources.size(); ++i) {
    events.push_back(trace_name("thread_name", network.resources.name(ResourceId{i}), 2, i));
    for (const detail::Bar& bar : detail::uses_of(network, result, ResourceId{i}))
      events.push_back(
          trace_event(network.label(bar.node), in_seconds(bar.from), in_seconds(bar.until), 2, i));
  }
  return type::to_json(Value::map({{"traceEvents", std::move(events)}, {"displayTimeUnit", "ms"}}), -1) +
         "\n";
}

}  // namespace segue::cdtn

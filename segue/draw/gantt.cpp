// SPDX-License-Identifier: Apache-2.0
#include <segue/draw/gantt.hpp>

#include <algorithm>

namespace segue::draw {

void Gantt::arrange() {
  std::ranges::stable_sort(bars, {}, &Bar::from);
  std::vector<TimePoint> free;
  for (std::uint32_t i = 0; i < bars.size(); ++i) {
    Bar& bar = bars[i];
    const auto lane = std::ranges::find_if(free, [&](TimePoint until) { return until <= bar.from; });
    bar.lane = static_cast<std::size_t>(lane - free.begin());
    if (lane == free.end())
      free.push_back(bar.until);
    else
      *lane = bar.until;
    Node& node = nodes[bar.node];
    node.bars.push_back(i);
    for (const std::uint32_t resource : node.resources)
      resources[resource].bars.push_back(i);
  }
}

namespace {

Gantt::Node node_of(const task_network::TaskNetwork& network, const task_network::RunResult& result,
                    const task_network::WaitFinder& waits, task_network::NodeId id) {
  const task_network::NodeResult& own = result.nodes[index(id)];
  Gantt::Node node;
  node.name = network.label(id);
  node.kind = network[id].kind;
  node.status = own.status;
  const bool ended =
      own.status != task_network::NodeStatus::NotReached && own.status != task_network::NodeStatus::Skipped;
  if (!ended) return node;
  node.outcome = network.outcomes.name(static_cast<std::uint32_t>(own.outcome));
  node.speculative = own.status == task_network::NodeStatus::Done && waits.time_ahead(id).has_value();
  node.waits = waits.of(id);
  return node;
}

/// Where the nodes of the network are in the drawing; kNone: nowhere.
std::vector<std::uint32_t> places_of(std::span<const task_network::NodeId> listed, std::size_t count) {
  std::vector<std::uint32_t> places(count, task_network::kNone);
  for (std::uint32_t i = 0; i < listed.size(); ++i)
    places[index(listed[i])] = i;
  return places;
}

}  // namespace

Gantt gantt_of(const task_network::TaskNetwork& network, const task_network::RunResult& result,
               const task_network::WaitFinder& waits, std::span<const task_network::NodeId> listed,
               const task_network::RunSummary& summary) {
  Gantt gantt;
  gantt.name = network.name;
  gantt.outcome = outcome_of(result);
  gantt.makespan = result.makespan;
  gantt.summary = summary;
  gantt.statistics = result.statistics;
  for (std::uint32_t i = 0; i < network.resources.size(); ++i)
    gantt.resources.push_back({network.resources.name(task_network::ResourceId{i})});
  const auto places = places_of(listed, result.nodes.size());
  const auto place = [&](task_network::NodeId node) {
    return index(node) < places.size() ? places[index(node)] : task_network::kNone;
  };
  for (const task_network::NodeId id : listed) {
    const task_network::NodeResult& own = result.nodes[index(id)];
    Gantt::Node node = node_of(network, result, waits, id);
    for (task_network::Wait& wait : node.waits)
      wait.node = task_network::NodeId{place(wait.node)};
    for (const task_network::Claim& claim : network.claims(id)) {
      if (std::ranges::find(node.resources, index(claim.resource)) == node.resources.end())
        node.resources.push_back(index(claim.resource));
    }
    if (own.attempts > 0 && !node.outcome.empty()) gantt.bars.push_back({place(id), own.started, own.ended});
    gantt.nodes.push_back(std::move(node));
  }
  for (const task_network::WastedRun& run : result.wasted) {
    if (place(run.node) != task_network::kNone)
      gantt.bars.push_back({place(run.node), run.started, run.ended, 0, true});
  }
  for (const task_network::NodeId node : waits.critical_chain()) {
    if (place(node) != task_network::kNone) gantt.nodes[place(node)].critical = true;
  }
  gantt.arrange();
  return gantt;
}

}  // namespace segue::draw

// SPDX-License-Identifier: Apache-2.0
#include "part.hpp"

namespace segue::task_network {

namespace {

/// `places`: by node, where it is in the part; kNone: it is not.
NodeSpec spec_of(const TaskNetwork& network, NodeId node, const std::vector<std::uint32_t>& places) {
  const NodeRecord& entry = network[node];
  NodeSpec spec;
  spec.kind = entry.kind;
  spec.duration = entry.duration;
  spec.expected = entry.expected;
  spec.branches = entry.branches;
  spec.handles_abort = entry.handles_abort;
  spec.opaque_subtree = entry.opaque_subtree;
  spec.opaque = entry.opaque;
  spec.reads_world = entry.reads_world;
  spec.uncertain = entry.uncertain;
  spec.reads_beside = entry.reads_beside;
  spec.cannot_fail = entry.cannot_fail;
  spec.strict = entry.strict;
  spec.structural = entry.structural;
  spec.parallel_branch = entry.parallel_branch;
  for (const Access& access : network.accesses(node)) {
    if (access.reads) spec.preconditions.push_back({access.fact, access.needed});
    if (access.writes) spec.effects.push_back({access.fact, access.value});
  }
  for (Claim claim : network.claims(node)) {
    if (claim.group != kNone && claim.op == ResourceOp::Exists) continue;  // what holds them comes before
    claim.group = kNone;
    spec.claims.push_back(claim);
  }
  for (DataInput input : network.inputs(node)) {
    const std::uint32_t producer = places[index(input.producer)];
    input.producer = NodeId{producer};
    if (producer != kNone) spec.inputs.push_back(input);
  }
  for (Condition condition : network.conditions(node)) {
    const std::uint32_t decides = places[index(condition.node)];
    condition.node = NodeId{decides};
    if (decides != kNone) spec.conditions.push_back(condition);
  }
  return spec;
}

}  // namespace

NetworkPart part_of(const TaskNetwork& network, const std::vector<bool>& keep) {
  NetworkPart part;
  part.network.facts = network.facts;
  part.network.resources = network.resources;
  part.network.initial_world = network.initial_world;
  part.network.take_parallel_branches_of(network);
  std::vector<std::uint32_t> places(network.size(), kNone);
  for (std::uint32_t i = 0; i < network.size(); ++i) {
    if (!keep[i]) continue;
    places[i] = part.network.size();
    part.network.append(spec_of(network, NodeId{i}, places), network[NodeId{i}].name);
    part.nodes.push_back(NodeId{i});
  }
  return part;
}

}  // namespace segue::task_network

// SPDX-License-Identifier: Apache-2.0
#include "flat_file.hpp"

#include <segue/base/input_file.hpp>
#include <segue/base/text.hpp>
#include <segue/task_network/flat_reader.hpp>
#include <segue/type/json.hpp>

#include <algorithm>
#include <cmath>

namespace segue::task_network {

using type::Value;
using type::ValueMap;

std::optional<FlatNetwork> read_flat_network(std::string_view text, const std::string& file,
                                             Diagnostics& diagnostics) {
  const auto value = type::parse_json(text, file);
  if (!value) {
    diagnostics.error("parse-error", value.error().message, value.error().where);
    return std::nullopt;
  }
  const std::size_t before = diagnostics.error_count();
  FlatNetwork flat;
  detail::FlatReader(flat, file, diagnostics).read(*value);
  if (diagnostics.error_count() > before) return std::nullopt;
  check_resources(flat.network, file, diagnostics);
  if (diagnostics.error_count() > before) return std::nullopt;
  return flat;
}

std::optional<FlatNetwork> load_flat_network(const std::filesystem::path& file, Diagnostics& diagnostics) {
  const auto text = read_input_file(file);
  if (!text) {
    diagnostics.error("unreadable-file", text.error().message, {file.string(), 0, 0});
    return std::nullopt;
  }
  return read_flat_network(*text, file.string(), diagnostics);
}

/// Tracks the largest possible number of units: everything is created, nothing conditional is taken away.
void check_resources(const TaskNetwork& network, const std::string& file, Diagnostics& diagnostics) {
  std::vector<std::int64_t> most;
  for (std::uint32_t i = 0; i < network.resources.size(); ++i)
    most.push_back(network.resources[ResourceId{i}].count);
  for (std::uint32_t i = 0; i < network.size(); ++i) {
    const NodeId node{i};
    for (const Claim& claim : network.claims(node)) {
      std::int64_t& units = most[index(claim.resource)];
      if (claim.op != ResourceOp::Create && claim.op != ResourceOp::Release && claim.count > units) {
        diagnostics.error(
            "missing-resource",
            "node " + quote(network.label(node)) + " needs " + std::to_string(claim.count) + " of " +
                quote(network.resources.name(claim.resource)) + ", of which there are at most " +
                std::to_string(units) +
                " when its turn comes; give the resource a larger count, or let an earlier node create it",
            {file, 0, 0});
        units = claim.count;
      }
    }
    for (const Claim& claim : network.claims(node)) {
      const bool gone = claim.op == ResourceOp::Consume || claim.op == ResourceOp::Delete;
      if (claim.op == ResourceOp::Create) most[index(claim.resource)] += claim.count;
      if (gone && network.conditions(node).empty()) most[index(claim.resource)] -= claim.count;
    }
  }
}

namespace {

Value effect_list(const FactTable& facts, const std::vector<Literal>& literals) {
  Value::List list;
  for (const Literal& literal : literals)
    list.emplace_back((literal.value ? "+" : "-") + facts.text(literal.fact));
  return list;
}

Value claims_value(const TaskNetwork& network, NodeId node) {
  Value::List list;
  for (const Claim& claim : network.claims(node)) {
    ValueMap entry;
    entry.set("name", network.resources.name(claim.resource));
    entry.set("op", kResourceOps[static_cast<std::size_t>(claim.op)]);
    if (claim.count != 1) entry.set("count", static_cast<std::uint64_t>(claim.count));
    list.emplace_back(std::move(entry));
  }
  return list;
}

void set_facts(ValueMap& entry, const TaskNetwork& network, NodeId node) {
  Value::List preconditions;
  std::vector<Literal> effects;
  for (const Access& access : network.accesses(node)) {
    if (access.reads) preconditions.emplace_back(network.facts.text(Literal{access.fact, access.needed}));
    if (access.writes) effects.push_back({access.fact, access.value});
  }
  entry.set("preconditions", std::move(preconditions));
  entry.set("effects", effect_list(network.facts, effects));
}

Value flows_value(const TaskNetwork& network, NodeId node) {
  Value::List list;
  for (const DataInput& input : network.inputs(node)) {
    list.push_back(Value::list({network.label(input.producer), network.names.name(input.output),
                                network.label(node), network.names.name(input.input)}));
  }
  return list;
}

Value conditions_value(const TaskNetwork& network, NodeId node) {
  Value::List list;
  for (const Condition& condition : network.conditions(node)) {
    ValueMap entry;
    entry.set("node", network.label(condition.node));
    entry.set("outcome", network.outcomes.name(static_cast<std::uint32_t>(condition.outcome)));
    if (condition.likelihood != Condition::kCertain)
      entry.set("likelihood", std::round(condition.share() * 1e4) / 1e4);
    list.emplace_back(std::move(entry));
  }
  return list;
}

Value node_value(const FlatNetwork& flat, NodeId node) {
  const TaskNetwork& network = flat.network;
  const NodeRecord& source = network[node];
  ValueMap entry;
  entry.set("seq", static_cast<std::uint64_t>(index(node)));
  entry.set("name", network.label(node));
  entry.set("duration_s", std::chrono::duration<double>(source.duration).count());
  entry.set("pia", source.kind == ActionClass::Irreversible);
  entry.set("control_flow", source.opaque_subtree ? "routine" : source.branches ? "condition" : "plain");
  set_facts(entry, network, node);
  entry.set("resources", claims_value(network, node));
  entry.set("data_flows", flows_value(network, node));
  entry.set("condition_deps", conditions_value(network, node));
  if (source.kind == ActionClass::Sensing) entry.set("sensing", true);
  entry.set("opaque", source.opaque);
  if (source.uncertain) entry.set("uncertain", true);
  if (source.cannot_fail) entry.set("cannot_fail", true);
  if (source.strict) entry.set("strict", true);
  if (source.expected != kSuccess)
    entry.set("expected", network.outcomes.name(static_cast<std::uint32_t>(source.expected)));
  const Trial trial = index(node) < flat.trials.size() ? flat.trials[index(node)] : Trial{};
  if (trial.outcome == kAborted)
    entry.set("fails", true);
  else if (trial.outcome != source.expected || trial.outcome != kSuccess)
    entry.set("outcome", network.outcomes.name(static_cast<std::uint32_t>(trial.outcome)));
  if (trial.effects) entry.set("actual_effects", effect_list(network.facts, *trial.effects));
  return entry;
}

}  // namespace

std::string write_flat_network(const FlatNetwork& flat) {
  const TaskNetwork& network = flat.network;
  ValueMap root;
  root.set("name", network.name);
  Value::List world;
  for (const std::string& fact : network.initial_world.texts(network.facts))
    world.emplace_back(fact);
  root.set("initial_world", std::move(world));
  if (!network.goal.empty()) {
    Value::List goal;
    for (const Literal& literal : network.goal)
      goal.emplace_back(network.facts.text(literal));
    root.set("goal", std::move(goal));
  }
  ValueMap resources;
  for (std::uint32_t i = 0; i < network.resources.size(); ++i) {
    const ResourceRecord& resource = network.resources[ResourceId{i}];
    ValueMap entry;
    entry.set("class", kResourceClasses[static_cast<std::size_t>(resource.kind)]);
    entry.set("count", static_cast<std::uint64_t>(resource.count));
    if (resource.commutes) entry.set("commutes", true);
    resources.set(network.resources.name(ResourceId{i}), std::move(entry));
  }
  root.set("resources", std::move(resources));
  Value::List nodes;
  for (std::uint32_t i = 0; i < network.size(); ++i)
    nodes.push_back(node_value(flat, NodeId{i}));
  root.set("nodes", std::move(nodes));
  return type::to_json(root, 1) + "\n";
}

}  // namespace segue::task_network

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/ros2/node_graph.hpp>
#include <segue/type/value.hpp>

/// The graph of nodes as values, for people and programs.
namespace segue::ros2 {

/// All nodes, sorted by name; the endpoints of those that share one are together. Each is a map:
/// {name: /talker, managed: false, publishers: [{topic, type, hash, quality: {reliability, ...}}],
/// subscriptions: (the same), services: [{name, type}], clients, actions, action_clients: (the same),
/// copies: 1, unseen_endpoints: 0}. `unseen_endpoints` are those that the node has named and that have not
/// been found yet. The topics and services of which actions consist are not listed among the others. `hash`
/// is empty where the node does not tell it (before Iron); the depth of a quality is never told. Services and
/// actions have `hashes`: {TYPE: HASH} where they tell some, by the names of their parts: from Iron on those
/// of requests, responses and feedback, from Lyrical on those of services.
type::Value::List describe_nodes(const GraphSnapshot& graph);

/// All topics, sorted by name, but for the parts of actions: {topic, types: [TYPE], publishers: [NODE],
/// subscriptions: [NODE], mismatches: [{publisher: NODE, subscription: NODE, reasons: [TEXT]}]}. A name is ""
/// where no node says that the endpoint is its own. Mismatches, NodeGraph::kMostMismatches of a topic at
/// most, are the pairs between which no samples travel, as mismatches() says or since their types differ.
type::Value::List describe_topics(const GraphSnapshot& graph);

}  // namespace segue::ros2

// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/graph_description.hpp>

#include <segue/base/text.hpp>
#include <segue/ros2/dds_names.hpp>
#include <segue/ros2/told_interface.hpp>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>

namespace segue::ros2 {
namespace {

using type::Value;
using type::ValueMap;

constexpr std::string_view kActionPart = "/_action/";

/// Of an endpoint: which service or action it is a part of.
struct Role {
  std::string name;  ///< "/lamp/set"
  std::string type;  ///< "std_srvs/srv/SetBool"
  bool serves = false;
  bool is_action = false;
  bool is_first = false;  ///< the part by which it is known
  TypeHashes hashes{};    ///< that the endpoint tells
};

bool drop_suffix(std::string& text, std::string_view suffix) {
  if (!text.ends_with(suffix)) return false;
  text.resize(text.size() - suffix.size());
  return true;
}

/// Of an endpoint of requests, which servers read and clients write, or of responses.
std::optional<Role> role_in_service(const Endpoint& endpoint) {
  const bool is_request = endpoint.topic.starts_with("rq/");
  if (!is_request && !endpoint.topic.starts_with("rr/")) return {};
  Role role{endpoint.topic.substr(2), interface_of_dds_type(endpoint.type), is_request != endpoint.publishes};
  role.is_first = is_request;
  if (!endpoint.type_hash.empty()) role.hashes[role.type] = endpoint.type_hash;
  if (!drop_suffix(role.name, is_request ? "Request" : "Reply") ||
      !drop_suffix(role.type, is_request ? "_Request" : "_Response"))
    return {};
  if (!endpoint.service_hash.empty()) role.hashes[role.type] = endpoint.service_hash;
  return role;
}

/// Nothing for those that are no parts of a service or action, and for the cancel service of actions.
std::optional<Role> role_of(const Endpoint& endpoint) {
  auto role = role_in_service(endpoint);
  if (!role && !endpoint.topic.starts_with("rt/")) return {};
  if (!role) {
    role = Role{endpoint.topic.substr(2), interface_of_dds_type(endpoint.type), endpoint.publishes};
    if (!endpoint.type_hash.empty()) role->hashes[role->type] = endpoint.type_hash;
  }
  const std::size_t at = role->name.find(kActionPart);
  if (at == std::string::npos) return role;
  const std::string part = role->name.substr(at + kActionPart.size());
  // An action is known by the first of its services.
  role->is_first = role->is_first && part == "send_goal";
  if (!(part == "send_goal" && drop_suffix(role->type, "_SendGoal")) &&
      !(part == "get_result" && drop_suffix(role->type, "_GetResult")) &&
      !(part == "feedback" && drop_suffix(role->type, "_FeedbackMessage")))
    return {};
  role->name.resize(at);
  role->is_action = true;
  return role;
}

bool is_topic(const Endpoint& endpoint) {
  return endpoint.topic.starts_with("rt/") && endpoint.topic.find(kActionPart) == std::string::npos;
}

Value to_value(const Quality& quality) {
  ValueMap map;
  map.set("reliability", to_string(quality.reliability));
  map.set("durability", to_string(quality.durability));
  if (quality.liveliness != Liveliness::Automatic) map.set("liveliness", to_string(quality.liveliness));
  for (const auto& [name, duration] :
       {std::pair{"deadline", quality.deadline}, {"lifespan", quality.lifespan}, {"lease", quality.lease}}) {
    if (duration.count() > 0) map.set(name, format_duration(duration));
  }
  return map;
}

Value topic_value(const Endpoint& endpoint) {
  return Value::map({{"topic", topic_of_dds_name(endpoint.topic)},
                     {"type", interface_of_dds_type(endpoint.type)},
                     {"hash", endpoint.type_hash},
                     {"quality", to_value(endpoint.quality)}});
}

/// A service or an action of a node.
struct Used {
  std::string type;  ///< empty: nothing but other parts of it have been found
  TypeHashes hashes;
};

/// A node with all that belongs to its name.
struct Collected {
  std::vector<Value> publishers;
  std::vector<Value> subscriptions;
  std::map<std::string, Used> services, clients, actions, action_clients;
  std::map<std::string, int> servers;  ///< by service
  int unseen = 0;

  void add(const Endpoint& endpoint) {
    if (is_topic(endpoint))
      return (endpoint.publishes ? publishers : subscriptions).push_back(topic_value(endpoint));
    auto role = role_of(endpoint);
    if (!role) return;
    auto& list =
        role->is_action ? (role->serves ? actions : action_clients) : (role->serves ? services : clients);
    Used& used = list[role->name];
    used.hashes.merge(role->hashes);
    if (!role->is_first) return;
    used.type = role->type;
    if (role->serves) ++servers[role->name];
  }
};

Value sorted(std::vector<Value> topics) {
  std::ranges::sort(topics, {}, [](const Value& one) { return one.find("topic")->as_string(); });
  return Value(std::move(topics));
}

Value to_value(const std::map<std::string, Used>& services) {
  Value::List list;
  for (const auto& [name, used] : services) {
    if (used.type.empty()) continue;
    Value one = Value::map({{"name", name}, {"type", used.type}});
    ValueMap hashes;
    for (const auto& [part, hash] : used.hashes)
      hashes.set(part, hash);
    if (!used.hashes.empty()) one.as_map().set("hashes", Value(std::move(hashes)));
    list.push_back(std::move(one));
  }
  return Value(std::move(list));
}

Value to_value(const std::string& name, Collected node) {
  const auto serves = [&](const char* service, std::string_view type) {
    const auto found = node.services.find(name + service);
    return found != node.services.end() && found->second.type == type;
  };
  int copies = 1;
  for (const auto& [service, count] : node.servers)
    copies = std::max(copies, service.starts_with(name + "/") ? count : 1);
  return Value::map({{"name", name},
                     {"managed", serves("/change_state", "lifecycle_msgs/srv/ChangeState") &&
                                     serves("/get_state", "lifecycle_msgs/srv/GetState")},
                     {"publishers", sorted(std::move(node.publishers))},
                     {"subscriptions", sorted(std::move(node.subscriptions))},
                     {"services", to_value(node.services)},
                     {"clients", to_value(node.clients)},
                     {"actions", to_value(node.actions)},
                     {"action_clients", to_value(node.action_clients)},
                     {"copies", copies},
                     {"unseen_endpoints", node.unseen}});
}

std::map<Gid, std::string> owners(const GraphSnapshot& graph) {
  std::map<Gid, std::string> nodes;
  for (const SeenParticipant& participant : graph.participants) {
    for (const NodeEntities& node : participant.entities.nodes) {
      for (const auto* gids : {&node.publishers, &node.subscriptions}) {
        for (const Gid& gid : *gids)
          nodes[gid] = full_name(node);
      }
    }
  }
  return nodes;
}

/// The endpoints of a topic, each with its node ("": of none).
struct Topic {
  using End = std::pair<std::string, const Endpoint*>;
  std::set<std::string> types;
  std::vector<End> publishers, subscriptions;
};

Value names(const std::vector<Topic::End>& ends) {
  std::multiset<std::string> nodes;
  for (const auto& [node, endpoint] : ends)
    nodes.insert(node);
  return Value(Value::List(nodes.begin(), nodes.end()));
}

Value mismatches_of(const Topic& topic) {
  Value::List found;
  for (const auto& [from, offered] : topic.publishers) {
    for (const auto& [to, requested] : topic.subscriptions) {
      auto reasons = mismatches(offered->quality, requested->quality);
      if (offered->type != requested->type)
        reasons.insert(reasons.begin(), "type: " + interface_of_dds_type(offered->type) + " is offered, " +
                                            interface_of_dds_type(requested->type) + " is requested");
      if (reasons.empty()) continue;
      if (found.size() == NodeGraph::kMostMismatches) return Value(std::move(found));
      found.push_back(Value::map({{"publisher", from},
                                  {"subscription", to},
                                  {"reasons", Value(Value::List(reasons.begin(), reasons.end()))}}));
    }
  }
  return Value(std::move(found));
}

}  // namespace

Value::List describe_nodes(const GraphSnapshot& graph) {
  std::map<Gid, const Endpoint*> endpoints;
  for (const Endpoint& endpoint : graph.endpoints)
    endpoints[endpoint.gid] = &endpoint;
  std::map<std::string, Collected> nodes;
  for (const SeenParticipant& participant : graph.participants) {
    for (const NodeEntities& node : participant.entities.nodes) {
      Collected& collected = nodes[full_name(node)];
      for (const auto* gids : {&node.publishers, &node.subscriptions}) {
        for (const Gid& gid : *gids) {
          const auto found = endpoints.find(gid);
          if (found == endpoints.end()) {
            ++collected.unseen;
          } else {
            collected.add(*found->second);
          }
        }
      }
    }
  }
  Value::List all;
  for (auto& [name, node] : nodes)
    all.push_back(to_value(name, std::move(node)));
  return all;
}

Value::List describe_topics(const GraphSnapshot& graph) {
  const auto nodes = owners(graph);
  std::map<std::string, Topic> topics;
  for (const Endpoint& endpoint : graph.endpoints) {
    if (!is_topic(endpoint)) continue;
    Topic& topic = topics[topic_of_dds_name(endpoint.topic)];
    topic.types.insert(interface_of_dds_type(endpoint.type));
    const auto owner = nodes.find(endpoint.gid);
    (endpoint.publishes ? topic.publishers : topic.subscriptions)
        .emplace_back(owner == nodes.end() ? std::string() : owner->second, &endpoint);
  }
  Value::List all;
  for (const auto& [name, topic] : topics) {
    all.push_back(Value::map({{"topic", name},
                              {"types", Value(Value::List(topic.types.begin(), topic.types.end()))},
                              {"publishers", names(topic.publishers)},
                              {"subscriptions", names(topic.subscriptions)},
                              {"mismatches", mismatches_of(topic)}}));
  }
  return all;
}

}  // namespace segue::ros2

// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/node_graph.hpp>

#include <segue/base/text.hpp>
#include <segue/ros2/dds_names.hpp>
#include <segue/ros2/interface_names.hpp>

#include <algorithm>
#include <array>
#include <utility>

namespace segue::ros2 {
namespace {

/// Why samples of one type are not those of the other; empty: they are.
std::string difference(const Endpoint& own, const Endpoint& other) {
  if (own.type != other.type) {
    return "its type is " + interface_of_dds_type(other.type) + ", here it is " +
           interface_of_dds_type(own.type);
  }
  if (own.type_hash.empty() || other.type_hash.empty() || own.type_hash == other.type_hash) return {};
  return "its definition of " + interface_of_dds_type(own.type) + " is another one (" + other.type_hash +
         ", here " + own.type_hash + ")";
}

std::string hash_at(std::string_view key, std::string_view user_data) {
  constexpr std::size_t kLongestHash = 100;  // RIHS01_ and 64 digits, today
  for (const std::string_view entry : split(user_data, ';')) {
    if (!entry.starts_with(key)) continue;
    const std::string_view hash = entry.substr(key.size());
    return hash.size() <= kLongestHash && is_topic_token(hash) ? std::string(hash) : std::string();
  }
  return {};
}

}  // namespace

void NodeGraph::set(Endpoint endpoint) {
  const Lock lock(mutex_);
  const Gid gid = endpoint.gid;
  remove_from_topic(gid);
  of_topic_[endpoint.topic].insert(gid);
  endpoints_[gid] = std::move(endpoint);
}

void NodeGraph::remove_from_topic(const Gid& endpoint) {
  const auto known = endpoints_.find(endpoint);
  if (known == endpoints_.end()) return;
  const auto topic = of_topic_.find(known->second.topic);
  topic->second.erase(endpoint);
  if (topic->second.empty()) of_topic_.erase(topic);
}

void NodeGraph::remove(const Gid& endpoint) {
  const Lock lock(mutex_);
  remove_from_topic(endpoint);
  endpoints_.erase(endpoint);
}

void NodeGraph::add_participant(const Gid& participant, std::vector<UdpAddress> addresses) {
  const Lock lock(mutex_);
  found(participant).addresses = std::move(addresses);
}

SeenParticipant& NodeGraph::found(const Gid& participant) {
  SeenParticipant& seen = participants_[participant];
  seen.entities.participant = participant;
  if (seen.number == 0) seen.number = ++seen_so_far_;
  return seen;
}

void NodeGraph::forget_nodes(const SeenParticipant& participant) {
  for (const NodeEntities& node : participant.entities.nodes) {
    for (const auto* gids : {&node.subscriptions, &node.publishers}) {
      for (const Gid& gid : *gids)
        nodes_.erase(gid);
    }
  }
}

void NodeGraph::remove_participant(const Gid& participant) {
  const Lock lock(mutex_);
  const auto known = participants_.find(participant);
  if (known == participants_.end()) return;
  forget_nodes(known->second);
  participants_.erase(known);
}

void NodeGraph::set(const ParticipantEntities& entities) {
  const Lock lock(mutex_);
  SeenParticipant& participant = found(entities.participant);
  forget_nodes(participant);
  participant.entities = entities;
  for (const NodeEntities& node : entities.nodes) {
    for (const auto* gids : {&node.subscriptions, &node.publishers}) {
      for (const Gid& gid : *gids)
        nodes_[gid] = full_name(node);
    }
  }
}

/// Endpoints have the first bytes of their participant's identifier (DDSI-RTPS 2.3, 9.3.1).
bool NodeGraph::is_of_ros(const Gid& endpoint) const {
  constexpr std::array<std::uint8_t, 4> kParticipant = {0, 0, 1, 0xc1};
  Gid participant = endpoint;
  std::ranges::copy(kParticipant, participant.end() - kParticipant.size());
  const Lock lock(mutex_);
  return participants_.contains(participant);
}

std::vector<Endpoint> NodeGraph::endpoints(std::string_view dds_topic, bool publishes) const {
  std::vector<Endpoint> found;
  const Lock lock(mutex_);
  const auto topic = of_topic_.find(dds_topic);
  if (topic == of_topic_.end()) return found;
  for (const Gid& gid : topic->second) {
    if (const Endpoint& one = endpoints_.at(gid); one.publishes == publishes) found.push_back(one);
  }
  return found;
}

std::string NodeGraph::node_of(const Gid& endpoint) const {
  const Lock lock(mutex_);
  const auto found = nodes_.find(endpoint);
  return found == nodes_.end() ? std::string() : found->second;
}

std::uint64_t NodeGraph::seen_so_far() const {
  const Lock lock(mutex_);
  return seen_so_far_;
}

bool NodeGraph::has_node(std::string_view name, const Gid& own, std::uint64_t after) const {
  const Lock lock(mutex_);
  return std::ranges::any_of(participants_, [&](const auto& each) {
    return each.first != own && each.second.number > after &&
           std::ranges::any_of(each.second.entities.nodes,
                               [&](const NodeEntities& node) { return full_name(node) == name; });
  });
}

GraphSnapshot NodeGraph::snapshot() const {
  GraphSnapshot all;
  const Lock lock(mutex_);
  for (const auto& [gid, participant] : participants_)
    all.participants.push_back(participant);
  for (const auto& [gid, endpoint] : endpoints_)
    all.endpoints.push_back(endpoint);
  return all;
}

std::vector<Mismatch> NodeGraph::mismatches_of(const Endpoint& own) const {
  std::vector<Mismatch> found;
  for (const Endpoint& other : endpoints(own.topic, !own.publishes)) {
    if (found.size() == kMostMismatches) break;
    std::vector<std::string> reasons =
        own.publishes ? mismatches(own.quality, other.quality) : mismatches(other.quality, own.quality);
    if (std::string types = difference(own, other); !types.empty()) reasons.insert(reasons.begin(), types);
    if (reasons.empty()) continue;
    const std::string node = node_of(other.gid);
    found.push_back({(node.empty() ? std::string("a program that is not a node") : "node " + node) +
                         (other.publishes ? " publishes " : " subscribes to ") +
                         topic_of_dds_name(own.topic) + ", but " + listed(reasons),
                     !node.empty() || !is_of_ros(other.gid)});
  }
  return found;
}

Result<void> check(const Endpoint& endpoint) {
  constexpr std::size_t kLongestName = 256;
  for (const std::string& name : {endpoint.topic, endpoint.type}) {
    if (name.empty() || name.size() > kLongestName ||
        !std::ranges::all_of(name, [](char c) { return c >= ' ' && c <= '~'; }))
      return fail(ErrorCode::InvalidArgument, "it has an endpoint whose topic or type cannot be shown");
  }
  return {};
}

std::string type_hash_in(std::string_view user_data) {
  return hash_at("typehash=", user_data);
}

std::string service_hash_in(std::string_view user_data) {
  return hash_at("sertypehash=", user_data);
}

}  // namespace segue::ros2

// SPDX-License-Identifier: Apache-2.0
//
// What hostile participants of ROS 2 may say of themselves: the nodes that they have and their endpoints.
// Each step is a kind, a participant, a size and so many bytes.
#include "allocated.hpp"
#include "require.hpp"

#include <segue/ros2/graph_description.hpp>
#include <segue/ros2/node_graph.hpp>
#include <segue/ros2/participant_entities.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace segue::ros2 {
namespace {

using fuzz::require;
using testing::allocated;

using Input = std::span<const std::uint8_t>;

/// Takes bytes from the front, zeros where there are none left.
std::uint8_t take_byte(Input& input) {
  if (input.empty()) return 0;
  const std::uint8_t one = input.front();
  input = input.subspan(1);
  return one;
}

Input take_bytes(Input& input) {
  const std::size_t wanted = std::size_t{take_byte(input)} + 256U * take_byte(input);
  const Input taken = input.first(std::min(wanted, input.size()));
  input = input.subspan(taken.size());
  return taken;
}

Gid gid(std::uint8_t participant, std::uint8_t entity) {
  Gid made{};
  made.fill(participant);
  made.back() = entity;
  return made;
}

void say_nodes(NodeGraph& graph, const Gid& sender, Input bytes) {
  constexpr std::size_t kMostGrowth = 32;
  [[maybe_unused]] static const auto kDescribed = decode_participant_entities({});  // their types, once
  allocated = 0;
  const auto said = decode_participant_entities(std::as_bytes(bytes));
  require(allocated <= kMostGrowth * (bytes.size() + 8), "no more memory than the message justifies");
  if (!said) return;
  require(decode_participant_entities(encode(*said)) == said, "what was read can be written and read again");
  if (check(*said, sender)) graph.set(*said);
}

void say_endpoint(NodeGraph& graph, const Gid& sender, Input bytes) {
  const std::uint8_t flags = take_byte(bytes);
  const auto text = [&bytes] {
    const Input taken = take_bytes(bytes);
    return std::string(taken.begin(), taken.end());
  };
  Endpoint endpoint{
      gid(sender.front(), take_byte(bytes)), (flags & 1U) != 0, text(), text(), type_hash_in(text()), {}};
  if ((flags & 2U) != 0) endpoint.quality.reliability = Reliability::BestEffort;
  if (check(endpoint)) graph.set(std::move(endpoint));
}

void step(NodeGraph& graph, Input& input) {
  const std::uint8_t kind = take_byte(input);
  const Gid sender = gid(take_byte(input) % 4U, 0xc1);
  const Input bytes = take_bytes(input);
  switch (kind % 5U) {
    case 0:
      return say_nodes(graph, sender, bytes);
    case 1:
      return say_endpoint(graph, sender, bytes);
    case 2:
      return graph.remove(gid(sender.front(), bytes.empty() ? 0 : bytes.front()));
    case 3:
      return graph.remove_participant(sender);
    default:
      return graph.add_participant(sender);
  }
}

void require_printable(std::string_view text) {
  require(std::ranges::all_of(text, [](char c) { return c >= ' ' && c <= '~'; }), "a terminal can show it");
}

void look(const NodeGraph& graph) {
  const GraphSnapshot snapshot = graph.snapshot();
  for (const SeenParticipant& each : snapshot.participants) {
    for (const NodeEntities& node : each.entities.nodes) {
      require_printable(full_name(node));
      for (const Gid& one : node.publishers)
        require(same_participant(one, each.entities.participant), "nobody has endpoints of others");
    }
  }
  for (const Endpoint& each : snapshot.endpoints) {
    require_printable(each.topic + each.type + each.type_hash);
    const auto same = graph.endpoints(each.topic, each.publishes);
    require(std::ranges::any_of(same, [&](const Endpoint& one) { return one.gid == each.gid; }),
            "each is among those of its topic");
  }
  for (const bool publishes : {false, true}) {
    const Endpoint own{gid(9, 9), publishes, "rt/chatter", "std_msgs::msg::dds_::String_", "RIHS01_a", {}};
    for (const Mismatch& one : graph.mismatches_of(own))
      require_printable(one.text);
  }
  require(describe_nodes(snapshot).size() <= snapshot.participants.size() * kMostNodes,
          "nodes are those that were said");
  static_cast<void>(describe_topics(snapshot));
}

}  // namespace
}  // namespace segue::ros2

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  segue::ros2::NodeGraph graph;
  segue::ros2::Input input(data, size);
  while (!input.empty())
    segue::ros2::step(graph, input);
  segue::ros2::look(graph);
  return 0;
}

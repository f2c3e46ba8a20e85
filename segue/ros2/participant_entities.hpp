// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace segue::ros2 {

/// The GUID of a participant, publisher or subscription on DDS.
using Gid = std::array<std::uint8_t, 16>;

/// Whether both are of one participant: their first twelve bytes.
inline bool same_participant(const Gid& a, const Gid& b) {
  return std::equal(a.begin(), a.begin() + 12, b.begin());
}

/// A node, and the endpoints on DDS that are its own.
struct NodeEntities {
  std::string name_space = "/";
  std::string name;
  std::vector<Gid> subscriptions{};
  std::vector<Gid> publishers{};
  friend bool operator==(const NodeEntities&, const NodeEntities&) = default;
};

/// A participant of DDS and its nodes: rmw_dds_common/msg/ParticipantEntitiesInfo, which each participant of
/// ROS 2 publishes on the topic "ros_discovery_info".
struct ParticipantEntities {
  Gid participant{};
  std::vector<NodeEntities> nodes{};
  /// How the message is written: before Iron, identifiers have 24 bytes, of which 16 are used. Nodes of
  /// either kind cannot read what those of the other one write.
  bool before_iron = false;
  friend bool operator==(const ParticipantEntities&, const ParticipantEntities&) = default;
};

/// "/talker", "/robot/talker"
std::string full_name(const NodeEntities& node);

/// The message as CDR.
std::vector<std::byte> encode(const ParticipantEntities& entities);
/// Reads it as written by any ROS 2. Nothing where it is neither. The bytes are untrusted.
std::optional<ParticipantEntities> decode_participant_entities(std::span<const std::byte> message);

/// How many nodes a participant may have.
inline constexpr std::size_t kMostNodes = 1000;
/// Whether the participant that `sender` belongs to may say that. InvalidArgument: it speaks for another
/// participant or about endpoints of others, has more than kMostNodes nodes, or one whose name is not one of
/// ROS 2.
Result<void> check(const ParticipantEntities& entities, const Gid& sender);

}  // namespace segue::ros2

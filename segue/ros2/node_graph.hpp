// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>
#include <segue/ros2/participant_entities.hpp>
#include <segue/ros2/quality.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace segue::ros2 {

/// A publisher or subscription of another participant.
struct Endpoint {
  Gid gid{};
  bool publishes = false;
  std::string topic;        ///< on DDS: "rt/chatter"
  std::string type;         ///< on DDS: "std_msgs::msg::dds_::String_"
  std::string type_hash{};  ///< "RIHS01_..."; empty where it says none (before Iron)
  Quality quality{};        ///< its depth is not known
  /// Of the service whose requests or responses it has; empty where it says none (before Lyrical).
  std::string service_hash{};
};

/// Where a participant gets what others say of themselves (UDP on IPv4).
struct UdpAddress {
  std::array<std::uint8_t, 4> host{};
  std::uint16_t port = 0;
};

/// A participant of ROS 2.
struct SeenParticipant {
  ParticipantEntities entities;
  std::vector<UdpAddress> addresses{};
  std::uint64_t number = 0;  ///< NodeGraph::seen_so_far() when it was found
};

/// All that is known at one time.
struct GraphSnapshot {
  std::vector<SeenParticipant> participants;
  std::vector<Endpoint> endpoints;
};

/// Why no samples travel between an own endpoint and another one on its topic.
struct Mismatch {
  std::string text;  ///< "node /talker publishes /chatter, but reliability: best_effort is offered, ..."
  bool is_named =
      true;  ///< false: its participant is one of ROS 2, which has not yet said whose endpoint it is
};

/// All that is known of nodes and their endpoints. Others must have been allowed to say it (check()). Any
/// thread.
class NodeGraph {
 public:
  /// Notes a participant of ROS 2, whose nodes will be told, or that it has other addresses now.
  void add_participant(const Gid& participant, std::vector<UdpAddress> addresses = {});
  /// Adds the endpoint, or replaces what is known of it.
  void set(Endpoint endpoint);
  void remove(const Gid& endpoint);
  /// The nodes of a participant, in place of those that it had.
  void set(const ParticipantEntities& entities);
  void remove_participant(const Gid& participant);

  /// The publishers or the subscriptions of a topic, by its name on DDS.
  [[nodiscard]] std::vector<Endpoint> endpoints(std::string_view dds_topic, bool publishes) const;
  /// "/talker"; empty where no node says that the endpoint is its own.
  [[nodiscard]] std::string node_of(const Gid& endpoint) const;
  /// How many participants have been found, including those that have left. One that comes back counts again.
  [[nodiscard]] std::uint64_t seen_so_far() const;
  /// Whether another participant than `own` has a node of that name ("/talker"); of those that have been
  /// found after so many others.
  [[nodiscard]] bool has_node(std::string_view name, const Gid& own, std::uint64_t after = 0) const;
  [[nodiscard]] GraphSnapshot snapshot() const;

  static constexpr std::size_t kMostMismatches = 100;
  /// Those between an own endpoint and those of others on its topic, kMostMismatches at most.
  [[nodiscard]] std::vector<Mismatch> mismatches_of(const Endpoint& own) const;

 private:
  mutable Mutex mutex_;
  void remove_from_topic(const Gid& endpoint) SEGUE_REQUIRES(mutex_);
  std::map<Gid, Endpoint> endpoints_ SEGUE_GUARDED_BY(mutex_);
  /// Each task looks at its topic whenever something changes.
  std::map<std::string, std::set<Gid>, std::less<>> of_topic_ SEGUE_GUARDED_BY(mutex_);
  /// It, which may be found only now.
  SeenParticipant& found(const Gid& participant) SEGUE_REQUIRES(mutex_);
  void forget_nodes(const SeenParticipant& participant) SEGUE_REQUIRES(mutex_);
  [[nodiscard]] bool is_of_ros(const Gid& endpoint) const;

  std::uint64_t seen_so_far_ SEGUE_GUARDED_BY(mutex_) = 0;
  std::map<Gid, SeenParticipant> participants_ SEGUE_GUARDED_BY(mutex_);
  std::map<Gid, std::string> nodes_ SEGUE_GUARDED_BY(mutex_);  ///< by endpoint
};

/// InvalidArgument where the names of its topic or type cannot be shown: those of DDS are printable ASCII, of
/// up to 256 characters, without control characters.
Result<void> check(const Endpoint& endpoint);

/// The hash in the user data of an endpoint, "typehash=RIHS01_...;"; empty where there is none, or none of
/// letters, digits and '_'.
std::string type_hash_in(std::string_view user_data);
/// In the same way, that of the service: "sertypehash=RIHS01_...;".
std::string service_hash_in(std::string_view user_data);

}  // namespace segue::ros2

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/ros2/participant_entities.hpp>
#include <segue/ros2/quality.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

/// Nodes of ROS 2 for tests: programs on Fast DDS and on Cyclone DDS that do what rmw_fastrtps and
/// rmw_cyclonedds do, written apart from the code that is tested.
namespace ros2::testing {

using Bytes = std::vector<std::byte>;

/// A publisher or a subscription, as ROS 2 says it.
struct TopicOf {
  std::string topic = "/chatter";
  std::string interface = "std_msgs/msg/String";
  std::string hash{};  ///< "RIHS01_...": of nodes from Iron on
  segue::ros2::Quality quality{};
};

/// The hashes that the endpoints of a service tell; empty ones are not told.
struct ServiceHashes {
  std::string request{};   ///< from Iron on
  std::string response{};  ///< from Iron on
  std::string whole{};     ///< that of the service, from Lyrical on
};

/// A request as a server of ROS 2 gets it.
struct Request {
  Bytes message;  ///< its CDR, with the header
  segue::ros2::Gid client{};
  std::int64_t number = 0;
};

/// A response as a client of ROS 2 gets it.
struct Response {
  std::int64_t number = 0;  ///< of its request
  Bytes message;
};

/// Hashes as they stand in the user data of an endpoint.
inline std::string hash_data(const std::string& type, const std::string& service = "") {
  return (type.empty() ? "" : "typehash=" + type + ";") +
         (service.empty() ? "" : "sertypehash=" + service + ";");
}

/// In the user data of endpoints on ros_discovery_info, from Iron on.
inline const std::string kEntitiesHash =
    "RIHS01_91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e";

class Peer {
 public:
  /// Before Iron, messages on ros_discovery_info have another form.
  explicit Peer(bool before_iron = false) : before_iron_(before_iron) {}
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;
  virtual ~Peer() = default;

  /// One of each at a time; the earlier one leaves.
  virtual void advertise(const TopicOf& topic) = 0;
  virtual void subscribe(const TopicOf& topic) = 0;
  /// Says on ros_discovery_info that its endpoints, those of its service included, are those of this node.
  virtual void announce(const std::string& node) = 0;
  /// Says that on ros_discovery_info as it is, true or not.
  virtual void say(const Bytes& entities) = 0;
  /// So many publishers of the topic beside the one of advertise(), of no node.
  virtual void advertise_more(const TopicOf& topic, std::size_t count) = 0;
  virtual void publish(const Bytes& message) = 0;
  /// The messages that have come since the last call.
  virtual std::vector<Bytes> take() = 0;
  /// Offers a service ("/add", "std_srvs/srv/SetBool"), one at a time; the earlier one leaves.
  virtual void serve(const std::string& service, const std::string& interface,
                     const ServiceHashes& hashes = {}) = 0;
  virtual void stop_serving() = 0;
  /// The requests that have come since the last call.
  virtual std::vector<Request> requests() = 0;
  /// Clients that get responses.
  virtual std::uint32_t clients() = 0;
  virtual void respond(const Request& request, const Bytes& response) = 0;
  /// Becomes a client of that service, one at a time; the earlier one leaves.
  virtual void use(const std::string& service, const std::string& interface) = 0;
  /// Servers that get requests and whose responses come.
  virtual std::uint32_t servers() = 0;
  /// Sends a request; its number.
  virtual std::int64_t ask(const Bytes& request) = 0;
  /// The responses to own requests that have come since the last call, with their numbers.
  virtual std::vector<Response> responses() = 0;
  /// The nodes of other participants, as each has said last in the form that this peer reads.
  std::vector<segue::ros2::ParticipantEntities> others();
  /// Messages of others in the form that it cannot read, as far as others() has taken them.
  [[nodiscard]] std::size_t misread() const { return misread_; }
  /// Subscriptions to what it publishes, and publishers of what it subscribes to.
  virtual std::uint32_t subscriptions() = 0;
  virtual std::uint32_t publishers() = 0;
  /// The user data of the first of these publishers.
  virtual std::string user_data_of_publisher() = 0;

 protected:
  [[nodiscard]] bool is_before_iron() const { return before_iron_; }
  /// That of its endpoints on ros_discovery_info.
  [[nodiscard]] std::string entities_hash() const { return before_iron_ ? "" : kEntitiesHash; }
  [[nodiscard]] virtual segue::ros2::Gid own_gid() const = 0;
  /// The messages of ros_discovery_info that have come since the last call.
  virtual std::vector<Bytes> take_entities() = 0;

 private:
  const bool before_iron_;
  std::size_t misread_ = 0;
  std::map<segue::ros2::Gid, segue::ros2::ParticipantEntities> others_;
};

inline std::vector<segue::ros2::ParticipantEntities> Peer::others() {
  for (const Bytes& message : take_entities()) {
    const auto entities = segue::ros2::decode_participant_entities(message);
    if (!entities || entities->participant == own_gid()) continue;
    if (entities->before_iron == before_iron_)
      others_[entities->participant] = *entities;
    else
      ++misread_;
  }
  std::vector<segue::ros2::ParticipantEntities> all;
  for (const auto& [gid, entities] : others_)
    all.push_back(entities);
  return all;
}

enum class Middleware { FastDds, Cyclone };

/// A participant of the domain, on the loopback device only.
std::unique_ptr<Peer> make_fast_peer(std::uint32_t domain);
std::unique_ptr<Peer> make_cyclone_peer(std::uint32_t domain);
/// The same, of ROS 2 before Iron.
std::unique_ptr<Peer> make_fast_peer_before_iron(std::uint32_t domain);
std::unique_ptr<Peer> make_cyclone_peer_before_iron(std::uint32_t domain);
/// Makes peers that share a participant, as the endpoints of a node do.
std::function<std::unique_ptr<Peer>()> fast_peers_of_one_node(std::uint32_t domain);
/// The same where peers leave and the participant goes on, as in a container.
std::function<std::unique_ptr<Peer>()> fast_peers_of_one_process(std::uint32_t domain);

}  // namespace ros2::testing

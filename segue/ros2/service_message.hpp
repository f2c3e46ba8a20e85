// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/ros2/participant_entities.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace segue::ros2 {

/// How a middleware of ROS 2 says which response answers which request. Topics are the same in both.
enum class ServiceMapping : std::uint8_t {
  FastDds,  ///< rmw_fastrtps: beside the message, as "related sample identity" of DDS-RPC
  Cyclone   ///< rmw_cyclonedds: in the message, before the request or response
};

/// The mapping of an endpoint, by the vendor that its identifier begins with (DDSI-RTPS 2.3, 9.3.1.5); those
/// of other vendors than Cyclone DDS are taken for Fast DDS's.
ServiceMapping mapping_of(const Gid& endpoint);

/// Which request of which client, in the mapping of Cyclone DDS.
struct RequestId {
  std::uint64_t client = 0;
  std::int64_t sequence = 0;
  friend bool operator==(const RequestId&, const RequestId&) = default;
};

/// A request or response as rmw_cyclonedds writes it: with its RequestId between the header of the CDR and
/// the rest.
std::vector<std::byte> with_request_id(const RequestId& id, std::span<const std::byte> message);

/// A request or response of rmw_cyclonedds, in its parts.
struct IdentifiedMessage {
  RequestId id;
  std::vector<std::byte> message;  ///< as CDR of its own, with the header
};
/// The inverse, in either byte order; nothing where the bytes are too few. They are untrusted.
std::optional<IdentifiedMessage> split_request_id(std::span<const std::byte> bytes);

/// The user data of the endpoints of a client, by which servers of rmw_cyclonedds wait for its response
/// reader: "clientid=1.f.0...;".
std::string client_user_data(const Gid& client);
/// Of the endpoints of a server: "serviceid=1.f.0...;".
std::string server_user_data(const Gid& server);

}  // namespace segue::ros2

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "own_addresses.hpp"
#include "participant.hpp"
#include "watched_transport.hpp"

#include <vector>

namespace ros2 {

/// How this process takes part in ROS 2. By UDP only: segments of shared memory would stay behind where a
/// process is killed, and are closed to other users. `peers`: the addresses of the static peers.
dds::DomainParticipantQos participant_quality(const Settings& settings, const std::vector<Ipv4Address>& peers,
                                              TransportOptions options);

}  // namespace ros2

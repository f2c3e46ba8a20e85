// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "participant.hpp"
#include "watched_transport.hpp"

namespace ros2 {

/// How this process takes part in ROS 2. By UDP only: segments of shared memory would stay behind where a
/// process is killed, and are closed to other users.
dds::DomainParticipantQos participant_quality(const Settings& settings, TransportOptions options);

}  // namespace ros2

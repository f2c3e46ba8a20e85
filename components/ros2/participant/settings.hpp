// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "participant.hpp"

#include <segue/base/result.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace ros2 {

/// Settings as users give them. `domain`: 0 to 232; -1: $ROS_DOMAIN_ID, or 0. `discovery`: localhost, subnet
/// or off; empty: as $ROS_LOCALHOST_ONLY or $ROS_AUTOMATIC_DISCOVERY_RANGE say, else subnet. `static_peers`:
/// empty: those of $ROS_STATIC_PEERS, which counts where it does in ROS 2: neither with $ROS_LOCALHOST_ONLY
/// nor without discovery. InvalidArgument where the environment or `discovery` says something else.
segue::Result<Settings> settings_from(std::int32_t domain, std::string_view discovery,
                                      const std::vector<std::string>& static_peers = {});

}  // namespace ros2

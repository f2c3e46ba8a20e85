// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "participant.hpp"

#include <segue/base/result.hpp>

#include <cstdint>
#include <string_view>

namespace ros2 {

/// Settings as users give them. `domain`: 0 to 232; -1: $ROS_DOMAIN_ID, or 0. `discovery`: localhost or
/// subnet; empty: as $ROS_AUTOMATIC_DISCOVERY_RANGE or $ROS_LOCALHOST_ONLY say, else subnet. InvalidArgument
/// where the environment or `discovery` says something else.
segue::Result<Settings> settings_from(std::int32_t domain, std::string_view discovery);

}  // namespace ros2

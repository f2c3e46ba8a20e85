// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "own_addresses.hpp"

#include <segue/base/result.hpp>

#include <string>
#include <vector>

namespace ros2 {

/// The addresses of computers, which are named as in $ROS_STATIC_PEERS: by IPv4 addresses or by names, of
/// which each counts with the first address that it has. Unavailable: one of them is not known. Asks the
/// system's resolver, which may take as long as it is configured to try.
segue::Result<std::vector<Ipv4Address>> addresses_of_peers(const std::vector<std::string>& peers);

}  // namespace ros2

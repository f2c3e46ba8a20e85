// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastdds/rtps/transport/TransportDescriptorInterface.h>

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace ros2 {

/// UDP by which Fast DDS 2.9 also understands how Cyclone DDS says that an endpoint or a participant has
/// left. Cyclone sends its key as the specification has it (DDSI-RTPS 2.3, 9.6.3.8: a serialized key, a list
/// of parameters), of which Fast DDS reads 16 bytes at most; such an endpoint would be there until its
/// process has ended.
std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> transport_that_sees_departures(
    std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> udp);

/// The message with serialized keys of discovery marked as data, which Fast DDS reads whole; empty where it
/// has none. `message` is an RTPS message, whose bytes are untrusted.
std::vector<std::byte> with_departures_as_data(std::span<const std::byte> message);

}  // namespace ros2

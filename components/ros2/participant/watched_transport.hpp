// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "own_addresses.hpp"

#include <segue/base/mutex.hpp>
#include <segue/ros2/rtps_message.hpp>

#include <fastdds/rtps/transport/TransportDescriptorInterface.h>

#include <atomic>
#include <functional>
#include <memory>
#include <string_view>
#include <vector>

namespace ros2 {

struct TransportOptions {
  /// Is told, in threads of Fast DDS, of each message by which readers acknowledge.
  std::function<void(const segue::ros2::Acknowledgement&)> acknowledged{};
  /// Is told, in threads of Fast DDS, of each message a part of which is refused, and why.
  std::function<void(const segue::ros2::Gid& sender, std::string_view why)> refused{};
  bool only_here = false;               ///< messages of other computers are dropped
  std::vector<Ipv4Address> and_from{};  ///< but for those of these
  bool alone = false;                   ///< nothing is sent, and all that comes is dropped
  /// Nothing is sent before it is true. (A participant of Fast DDS announces itself before it listens. Others
  /// answer within 0.1 ms, once; what it does not hear then, it hears when they announce themselves the next
  /// time, after seconds. Relaxed: no memory depends on it.)
  std::shared_ptr<const std::atomic<bool>> listens = std::make_shared<std::atomic<bool>>(true);
  /// Is held while Fast DDS looks at a message that has arrived. (It looks whether a reader has a listener,
  /// and then calls it, though the reader may be deleted in between by whoever does not hold this.)
  std::shared_ptr<segue::Mutex> receiving = std::make_shared<segue::Mutex>();
};

/// UDP with some additions to Fast DDS 2.9: what it receives is what it can read (readable_by_fast_dds), and
/// messages can go to addresses that it has not told the transport of before.
std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> watched_transport(
    std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> udp, TransportOptions options);

}  // namespace ros2

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/ros2/participant_entities.hpp>

#include <fastdds/rtps/transport/TransportDescriptorInterface.h>

#include <atomic>
#include <compare>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace ros2 {

/// That a reader of another participant has matched a writer: only then it acknowledges.
struct Acknowledgement {
  segue::ros2::Gid reader{};
  segue::ros2::Gid writer{};
  friend auto operator<=>(const Acknowledgement&, const Acknowledgement&) = default;
};

struct TransportOptions {
  /// Is told, in threads of Fast DDS, of each message by which readers acknowledge.
  std::function<void(const Acknowledgement&)> acknowledged;
  bool only_here = false;  ///< messages of other computers are dropped
  /// Nothing is sent before it is true. (A participant of Fast DDS announces itself before it listens. Others
  /// answer within 0.1 ms, once; what it does not hear then, it hears when they announce themselves the next
  /// time, after seconds. Relaxed: no memory depends on it.)
  std::shared_ptr<const std::atomic<bool>> listens{};
  /// Is held while Fast DDS looks at a message that has arrived. (It looks whether a reader has a listener,
  /// and then calls it, though the reader may be deleted in between by whoever does not hold this.)
  std::shared_ptr<segue::Mutex> receiving = std::make_shared<segue::Mutex>();
};

/// UDP with some additions to Fast DDS 2.9. It also understands how Cyclone DDS says that an endpoint or a
/// participant has left: Cyclone sends its key as the specification has it (DDSI-RTPS 2.3, 9.6.3.8: a
/// serialized key, a list of parameters), of which Fast DDS reads 16 bytes at most; such an endpoint would be
/// there until its process has ended. Messages can go to addresses that Fast DDS has not told it of before.
std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> watched_transport(
    std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> udp, TransportOptions options);

/// The acknowledgements of readers of users in an RTPS message, whose bytes are untrusted.
std::vector<Acknowledgement> acknowledgements_in(std::span<const std::byte> message);

/// The message with serialized keys of discovery marked as data, which Fast DDS reads whole; empty where it
/// has none. `message` is an RTPS message, whose bytes are untrusted.
std::vector<std::byte> with_departures_as_data(std::span<const std::byte> message);

}  // namespace ros2

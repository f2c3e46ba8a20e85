// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/ros2/participant_entities.hpp>

#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

/// Messages of DDS on the network (DDSI-RTPS 2.3, 9.4). Their bytes are untrusted.
namespace segue::ros2 {

/// The participant that has sent a message: a GUID whose entity is 0.
Gid sender_of(std::span<const std::byte> message);

/// That a reader of another participant has matched a writer: only then it acknowledges.
struct Acknowledgement {
  Gid reader{};
  Gid writer{};
  friend auto operator<=>(const Acknowledgement&, const Acknowledgement&) = default;
};

/// The acknowledgements of readers of users in a message.
std::vector<Acknowledgement> acknowledgements_in(std::span<const std::byte> message);

/// The most bytes of a sample that comes in fragments: of users, and of discovery.
inline constexpr std::size_t kLargestSample = std::size_t{256} << 20U;
inline constexpr std::size_t kLargestAnnouncement = std::size_t{1} << 20U;
/// The most samples of which one submessage may say that they will never come. A writer's heartbeat says it,
/// too, of those before its first one.
inline constexpr std::uint64_t kLongestGap = 10'000'000;
/// The most samples that a writer may have sent before the first one that it still has. (Each new reader in
/// Fast DDS counts up to it one by one, in Debian some millions in a second, and nothing else is received
/// meanwhile.)
inline constexpr std::uint64_t kMostSamples = 1'000'000'000;

/// A message as Fast DDS 2.9 can read it.
struct ReadableMessage {
  std::vector<std::byte> bytes{};  ///< empty: as it was
  std::string_view refused{};      ///< why a part of it was; empty: nothing was
};

/// The message for Fast DDS. Serialized keys of discovery are marked as data, which it reads whole: Cyclone
/// DDS says in this way that an endpoint or a participant has left (9.6.3.8: a serialized key, a list of
/// parameters), and of a key Fast DDS reads 16 bytes at most.
///
/// Refused are submessages that would make it read or write where it must not, use gigabytes, end its process
/// or work for minutes: data that begins behind its end, fragments that are not there, samples larger than
/// kLargestSample, gaps longer than kLongestGap, more samples than kMostSamples, numbers that overflow. They
/// become submessages of a vendor, which it skips.
ReadableMessage readable_by_fast_dds(std::span<const std::byte> message);

}  // namespace segue::ros2

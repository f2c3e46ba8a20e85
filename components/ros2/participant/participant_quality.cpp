// SPDX-License-Identifier: Apache-2.0
#include "participant_quality.hpp"

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

#include <random>
#include <utility>

namespace ros2 {
namespace {

namespace rtps = eprosima::fastrtps::rtps;

/// Buffers of sockets, so that large samples find room (the system limits them).
constexpr std::uint32_t kSocketBytes = 4U << 20U;
/// How many participants of a computer are looked for without multicast, as in ROS 2.
constexpr std::uint32_t kLocalParticipants = 32;
/// The participant's number in this process, from which its ports follow, unless others of this computer have
/// them. (Fast DDS would count on with each participant, until the ports are those of the next domain.) The
/// first ones are for others that this process may have.
constexpr std::int32_t kNumber = 4;
/// Participants without it are not part of ROS 2.
constexpr std::string_view kUserData = "enclave=/;";

/// Identifiers that nobody had before. Those of Fast DDS are the same for the next participant of a process,
/// which others then take for the one that has just left, and find after seconds only.
rtps::GuidPrefix_t new_identifier() {
  rtps::GuidPrefix_t prefix;
  std::random_device random;
  for (auto& one : prefix.value)
    one = static_cast<rtps::octet>(random());
  prefix.value[0] = rtps::c_VendorId_eProsima[0];
  prefix.value[1] = rtps::c_VendorId_eProsima[1];
  return prefix;
}

rtps::Locator_t multicast_group(std::uint32_t domain) {
  rtps::Locator_t group;
  rtps::IPLocator::setIPv4(group, 239, 255, 0, 1);
  group.port = rtps::PortParameters().getMulticastPort(domain);
  return group;
}

/// Finds those on this computer in all ways in which ROS 2 looks for them: by multicast, which does not leave
/// it (before Iron, on the loopback device), and at the ports of its first participants (from Iron on). They
/// may know the computer by any of its addresses. (A list of permitted interfaces, as before Iron, drops all
/// addresses but that of loopback.)
void keep_on_this_computer(std::uint32_t domain, dds::DomainParticipantQos& quality,
                           eprosima::fastdds::rtps::UDPv4TransportDescriptor& udp) {
  udp.TTL = 0;
  udp.maxInitialPeersRange = kLocalParticipants;
  rtps::Locator_t all;
  rtps::Locator_t here;
  rtps::IPLocator::setIPv4(here, 127, 0, 0, 1);
  const rtps::Locator_t group = multicast_group(domain);
  auto& builtin = quality.wire_protocol().builtin;
  for (const rtps::Locator_t& locator : {all, here}) {
    builtin.metatrafficUnicastLocatorList.push_back(locator);
    quality.wire_protocol().default_unicast_locator_list.push_back(locator);
  }
  builtin.metatrafficMulticastLocatorList.push_back(group);
  builtin.initialPeersList.push_back(group);
  builtin.initialPeersList.push_back(here);
}

/// Asks computers at the ports of their first participants, besides all others that are looked for.
void ask_peers(std::uint32_t domain, const std::vector<Ipv4Address>& peers,
               dds::DomainParticipantQos& quality, eprosima::fastdds::rtps::UDPv4TransportDescriptor& udp) {
  if (peers.empty()) return;
  udp.maxInitialPeersRange = kLocalParticipants;
  auto& asked = quality.wire_protocol().builtin.initialPeersList;
  if (asked.empty()) asked.push_back(multicast_group(domain));  // is left out where others are named
  for (const Ipv4Address& peer : peers) {
    rtps::Locator_t locator;
    rtps::IPLocator::setIPv4(locator, peer[0], peer[1], peer[2], peer[3]);
    asked.push_back(locator);
  }
}

/// Bounds of all that is kept of others: far more than a robot has.
void limit_others(dds::DomainParticipantQos& quality) {
  constexpr std::size_t kMostParticipants = 400;
  constexpr std::size_t kMostEndpoints = 20'000;  // of readers and of writers, of all participants together
  quality.allocation().participants = {0, kMostParticipants, 1};
  quality.allocation().readers = quality.allocation().writers = {0, kMostEndpoints / kMostParticipants, 1};
}

}  // namespace

dds::DomainParticipantQos participant_quality(const Settings& settings, const std::vector<Ipv4Address>& peers,
                                              TransportOptions options) {
  dds::DomainParticipantQos quality;
  quality.user_data().setValue({kUserData.begin(), kUserData.end()});
  auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->sendBufferSize = udp->receiveBufferSize = kSocketBytes;
  if (settings.range == Range::Localhost) keep_on_this_computer(settings.domain, quality, *udp);
  ask_peers(settings.domain, peers, quality, *udp);
  limit_others(quality);
  quality.wire_protocol().prefix = new_identifier();
  quality.wire_protocol().participant_id = kNumber;
  auto& discovery = quality.wire_protocol().builtin.discovery_config;
  discovery.initial_announcements = {50, {0, 20'000'000}};
  discovery.leaseDuration_announcementperiod = {1, 0};
  quality.transport().use_builtin_transports = false;
  quality.transport().user_transports = {watched_transport(udp, std::move(options))};
  return quality;
}

}  // namespace ros2

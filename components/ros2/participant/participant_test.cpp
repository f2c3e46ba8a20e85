// SPDX-License-Identifier: Apache-2.0
#include "participant.hpp"
#include "../look/local_process.hpp"
#include "../topics/topics_test_support.hpp"
#include "fast_quality.hpp"

#include <filesystem>
#include <set>

namespace ros2::testing {
namespace {

/// A domain whose ports are below those that the system gives to sockets that send.
std::uint32_t domain_with_low_ports() {
  return 90 + own_domain() % 10;
}

/// "socket:[INODE]" of all sockets of this process.
std::set<std::string> own_sockets() {
  std::set<std::string> found;
  for (const auto& file : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code unreadable;
    found.insert(std::filesystem::read_symlink(file.path(), unreadable).string());
  }
  return found;
}

/// The UDP ports of this process that belong to the domain and are those of one participant alone
/// (DDSI-RTPS 2.3, 9.6.1.1).
std::set<unsigned> ports_of(std::uint32_t domain) {
  constexpr unsigned kOfDomain = 250;
  constexpr unsigned kOfParticipants = 10;
  const unsigned first = 7400 + kOfDomain * domain + kOfParticipants;
  const auto sockets = own_sockets();
  std::set<unsigned> found;
  for (const UdpSocket& socket : udp_sockets()) {
    const bool is_of_participant = socket.port >= first && socket.port < first + kOfDomain - kOfParticipants;
    if (is_of_participant && sockets.contains(socket.file)) found.insert(socket.port);
  }
  return found;
}

TEST(OneParticipant, HasTheSamePortsWhenItJoinsAgain) {
  const Settings settings{domain_with_low_ports(), Range::Localhost};
  auto participant = Participant::join(settings).value();
  const auto ports = ports_of(settings.domain);
  EXPECT_EQ(ports.size(), 2U) << "for discovery and for all else";
  for (int i = 0; i < 3; ++i) {
    participant.reset();
    EXPECT_TRUE(ports_of(settings.domain).empty());
    participant = Participant::join(settings).value();
    EXPECT_EQ(ports_of(settings.domain), ports);
  }
}

TEST(OneParticipant, IsSharedByAllWhoWantTheSame) {
  const Settings settings{own_domain(), Range::Localhost};
  const auto first = Participant::join(settings).value();
  EXPECT_EQ(Participant::join(settings).value(), first);
  EXPECT_THAT(Participant::join({own_domain(), Range::Subnet}).error().message,
              HasSubstr("with other settings"));
  EXPECT_THAT(Participant::join({233, Range::Localhost}).error().message,
              HasSubstr("domain 233 does not exist"));
}

/// With the three seconds of Fast DDS, a node on Cyclone DDS would know only then what a latched topic has.
TEST(OneParticipant, RemindsReadersThatHaveNotAcknowledgedSoon) {
  const auto period = writer_quality({}, "").reliable_writer_qos().times.heartbeatPeriod;
  EXPECT_LE(period.to_ns(), 200'000'000);
  EXPECT_GT(period.to_ns(), 0);
}

}  // namespace
}  // namespace ros2::testing

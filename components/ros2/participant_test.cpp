// SPDX-License-Identifier: Apache-2.0
#include "participant.hpp"
#include "topics_test_support.hpp"

#include <fstream>
#include <set>
#include <sstream>

namespace ros2::testing {
namespace {

/// The UDP ports of this computer that belong to the domain and are those of one participant alone
/// (DDSI-RTPS 2.3, 9.6.1.1).
std::set<unsigned> ports_of(std::uint32_t domain) {
  constexpr unsigned kOfDomain = 250;
  constexpr unsigned kOfParticipants = 10;
  const unsigned first = 7400 + kOfDomain * domain + kOfParticipants;
  std::set<unsigned> found;
  std::ifstream file("/proc/net/udp");
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string number;
    std::string address;
    words >> number >> address;
    const auto colon = address.find(':');
    if (colon == std::string::npos) continue;
    const auto port = static_cast<unsigned>(std::stoul(address.substr(colon + 1), nullptr, 16));
    if (port >= first && port < first + kOfDomain - kOfParticipants) found.insert(port);
  }
  return found;
}

TEST(OneParticipant, HasTheSamePortsWhenItJoinsAgain) {
  const Settings settings{own_domain(), true};
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
  const Settings settings{own_domain(), true};
  const auto first = Participant::join(settings).value();
  EXPECT_EQ(Participant::join(settings).value(), first);
  EXPECT_THAT(Participant::join({own_domain(), false}).error().message, HasSubstr("with other settings"));
  EXPECT_THAT(Participant::join({233, true}).error().message, HasSubstr("domain 233 does not exist"));
}

}  // namespace
}  // namespace ros2::testing

// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/host_places.hpp>

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace segue::runtime {
namespace {

/// The addresses of a robot with hosts that have these; "" is the runtime's own, "?" where it is not known.
std::map<std::string, std::string> addresses_of(
    const std::vector<std::pair<std::string, std::string>>& hosts) {
  model::Robot robot;
  robot.name = "robot";
  for (const auto& [name, address] : hosts) {
    model::Host host;
    host.name = model::HostName(name);
    host.address = address;
    robot.hosts.push_back(std::move(host));
  }
  std::map<std::string, std::string> all;
  for (const auto& [name, address] : gateway_settings(robot).addresses)
    all.emplace(name == model::kLocalHost ? "" : name.str(), address);
  all.try_emplace("", "?");
  return all;
}

using Addresses = std::map<std::string, std::string>;

TEST(HostPlaces, HostsOnThisComputerMeetOnLoopback) {
  EXPECT_EQ(addresses_of({{"base", "local"}, {"arm", "unix:arm.sock"}}),
            (Addresses{{"", "127.0.0.1"}, {"arm", "127.0.0.1"}}));
}

TEST(HostPlaces, TheOwnAddressIsThatWhichLeadsToTheFirstOtherComputer) {
  EXPECT_EQ(addresses_of({{"base", "local"}, {"arm", "tcp://127.0.0.1:7447"}}),
            (Addresses{{"", "127.0.0.1"}, {"arm", "127.0.0.1"}}));
  EXPECT_EQ(
      addresses_of({{"here", "unix:here.sock"},
                    {"named", "tcp://no.such.name:7447"},
                    {"arm", "tcp://127.0.0.2:7447"}}),
      (Addresses{{"", "127.0.0.1"}, {"here", "127.0.0.1"}, {"named", "no.such.name"}, {"arm", "127.0.0.2"}}));
}

TEST(HostPlaces, HostsBehindSocketsHaveTheAddressOfThisComputerThatOthersReach) {
  EXPECT_EQ(addresses_of({{"here", "unix:here.sock"}, {"named", "tcp://no.such.name:7447"}}),
            (Addresses{{"", "?"}, {"named", "no.such.name"}}))
      << "not that of loopback, where others do not reach it";
}

TEST(HostPlaces, ProcessesLookForOthersAtAllAddressesThatAreKnown) {
  model::Robot robot;
  for (const char* address : {"tcp://127.0.0.2:7447", "unix:here.sock", "tcp://no.such.name:7447", "local"}) {
    robot.hosts.emplace_back();
    robot.hosts.back().name = model::HostName("h" + std::to_string(robot.hosts.size()));
    robot.hosts.back().address = address;
  }
  EXPECT_EQ(peer_addresses(robot), (std::vector<std::string>{"127.0.0.1", "127.0.0.2", "no.such.name"}));
}

TEST(HostPlaces, NoNameIsLookedUpForTheOwnAddress) {
  EXPECT_EQ(addresses_of({{"arm", "tcp://no.such.name:7447"}}),
            (Addresses{{"", "?"}, {"arm", "no.such.name"}}));
}

}  // namespace
}  // namespace segue::runtime

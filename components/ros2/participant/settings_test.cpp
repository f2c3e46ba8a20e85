// SPDX-License-Identifier: Apache-2.0
#include "settings.hpp"
#include "participant_quality.hpp"
#include "static_peers.hpp"

#include <gmock/gmock.h>

#include <fastrtps/utils/IPLocator.h>

#include <array>
#include <cstdlib>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace ros2 {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Peers = std::vector<std::string>;

/// The environment of a test, which is as before afterwards.
class Discovery : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* name : kVariables) {
      if (const char* value = std::getenv(name)) before_[name] = value;
      ::unsetenv(name);
    }
  }
  void TearDown() override {
    for (const char* name : kVariables)
      ::unsetenv(name);
    for (const auto& [name, value] : before_)
      ::setenv(name.c_str(), value.c_str(), 1);
  }
  static Settings settings(const std::string& discovery = "", const Peers& peers = {}) {
    auto made = settings_from(7, discovery, peers);
    EXPECT_TRUE(made);
    return made.value_or(Settings{});
  }

 private:
  static constexpr std::array kVariables = {"ROS_LOCALHOST_ONLY", "ROS_AUTOMATIC_DISCOVERY_RANGE",
                                            "ROS_STATIC_PEERS"};
  std::map<std::string, std::string> before_;
};

TEST_F(Discovery, HasTheRangeOfTheEnvironment) {
  EXPECT_EQ(settings(), (Settings{7, Range::Subnet, {}}));
  for (const auto& [text, range] : {std::pair{"SUBNET", Range::Subnet},
                                    {"SYSTEM_DEFAULT", Range::Subnet},
                                    {"LOCALHOST", Range::Localhost},
                                    {"OFF", Range::Off}}) {
    ::setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", text, 1);
    EXPECT_EQ(settings().range, range) << text;
    EXPECT_EQ(settings("subnet").range, Range::Subnet) << "the property goes before the environment";
  }
  ::setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "world", 1);
  EXPECT_THAT(settings_from(7, "").error().message,
              HasSubstr("$ROS_AUTOMATIC_DISCOVERY_RANGE is 'world': expected SUBNET, LOCALHOST, OFF or"));
}

TEST_F(Discovery, IsOfThisComputerWhereTheSwitchSaysSo) {
  ::setenv("ROS_LOCALHOST_ONLY", "1", 1);
  ::setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET", 1);
  ::setenv("ROS_STATIC_PEERS", "10.0.0.1", 1);
  EXPECT_EQ(settings(), (Settings{7, Range::Localhost, {}})) << "the switch goes before both, as in ROS 2";
  EXPECT_THAT(settings("localhost").static_peers, ElementsAre("10.0.0.1")) << "the property leaves them";
}

TEST_F(Discovery, HasStaticPeersOfTheEnvironmentOrItsOwn) {
  ::setenv("ROS_STATIC_PEERS", "10.0.0.1;;robot.local;", 1);
  EXPECT_THAT(settings().static_peers, ElementsAre("10.0.0.1", "robot.local"));
  EXPECT_THAT(settings("", {"10.0.0.2"}).static_peers, ElementsAre("10.0.0.2"));
  EXPECT_THAT(settings("off").static_peers, IsEmpty());
  ::setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "SYSTEM_DEFAULT", 1);
  EXPECT_THAT(settings().static_peers, IsEmpty());
  EXPECT_THAT(settings_from(7, "off", {"10.0.0.2"}).error().message, HasSubstr("but discovery is off"));
}

TEST(StaticPeers, AreAddressesOrNames) {
  EXPECT_EQ(addresses_of_peers({"203.0.113.2", "localhost"}).value(),
            (std::vector<Ipv4Address>{{203, 0, 113, 2}, {127, 0, 0, 1}}));
  const std::string no_name(300, 'x');
  EXPECT_THAT(addresses_of_peers({"127.0.0.1", no_name}).error().message,
              HasSubstr("is not known as an IPv4 address or a name"));
  EXPECT_EQ(Participant::join({7, Range::Localhost, {no_name}}).error().code, segue::ErrorCode::Unavailable);
}

/// "203.0.113.2:0" of all who are asked, where 0 stands for the ports of the first participants.
std::vector<std::string> asked(const Settings& settings, const std::vector<Ipv4Address>& peers) {
  std::vector<std::string> all;
  const auto quality = participant_quality(settings, peers, {});
  for (const auto& one : quality.wire_protocol().builtin.initialPeersList)
    all.push_back(eprosima::fastrtps::rtps::IPLocator::toIPv4string(one) + ":" + std::to_string(one.port));
  return all;
}

TEST(StaticPeers, AreAskedBesidesAllOthers) {
  EXPECT_THAT(asked({0, Range::Subnet, {}}, {}), IsEmpty()) << "as Fast DDS does by itself";
  EXPECT_THAT(asked({0, Range::Subnet, {}}, {{203, 0, 113, 2}}),
              ElementsAre("239.255.0.1:7400", "203.0.113.2:0"));
  EXPECT_THAT(asked({0, Range::Localhost, {}}, {{203, 0, 113, 2}}),
              ElementsAre("239.255.0.1:7400", "127.0.0.1:0", "203.0.113.2:0"));
}

}  // namespace
}  // namespace ros2

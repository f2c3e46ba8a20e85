// SPDX-License-Identifier: Apache-2.0
// Participants that lie about nodes, and that bring more than a robot has.
#include "hostile_participants_test_support.hpp"

#include <random>

namespace ros2::testing {
namespace {

using segue::ros2::Gid;

TEST_P(HostileParticipants, SayNothingAboutOthers) {
  ASSERT_TRUE(eventually([&] { return participant_of("/talker") != Gid{}; }));
  const Gid other = participant_of("/talker");
  hostile->announce("hostile");
  ASSERT_TRUE(eventually([&] { return participant_of("/hostile") != Gid{}; }));
  hostile->say(segue::ros2::encode({other, {{"/", "thief", {}, {}}}}));
  EXPECT_TRUE(lines.has({"participant", "is not taken: it speaks for another participant"}));
  hostile->announce("hostile_too");
  ASSERT_TRUE(eventually([&] { return participant_of("/hostile_too") != Gid{}; }));
  EXPECT_EQ(participant_of("/talker"), other);
  EXPECT_EQ(participant_of("/thief"), Gid{});
  EXPECT_TRUE(listens());
}

TEST_P(HostileParticipants, WhoseBytesAreNoMessagesAreNotHeard) {
  std::mt19937 random(7);
  const Bytes good = segue::ros2::encode({{}, {{"/", "one", {Gid{}}, {Gid{}, Gid{}}}}});
  for (std::size_t i = 0; i < 300; ++i) {
    Bytes bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(5 + random() % (good.size() - 5)));
    for (std::size_t k = 4 + i % 4; k < bytes.size(); k += 1 + i % 7)
      bytes[k] = static_cast<std::byte>(random());
    hostile->say(bytes);
  }
  hostile->say(segue::ros2::encode({{}, {{"/", "\033[2J", {}, {}}}}));
  hostile->announce("calm");
  EXPECT_TRUE(eventually([&] { return participant_of("/calm") != Gid{}; }));
  for (const auto& seen : participant->graph().snapshot().participants) {
    for (const auto& node : seen.entities.nodes)
      EXPECT_THAT(full_name(node), ::testing::AnyOf("/talker", "/calm", "/listener"));
  }
  EXPECT_TRUE(listens());
}

TEST_P(HostileParticipants, WithAThousandWrongEndpointsStopNothing) {
  constexpr std::size_t kMany = 1000;
  hostile->advertise({"/chatter", "std_msgs/msg/Int32", "", {}});
  hostile->advertise_more({"/chatter", "std_msgs/msg/Int32", "", {}}, kMany);
  hostile->announce("hostile");
  const std::string topic = "rt/chatter";
  EXPECT_TRUE(eventually([&] { return participant->graph().endpoints(topic, true).size() == kMany + 2; }));
  EXPECT_TRUE(lines.has({"node /hostile publishes /chatter, but its type is std_msgs/msg/Int32"}));
  EXPECT_EQ(subscription.count("mismatched"), segue::ros2::NodeGraph::kMostMismatches);
  EXPECT_TRUE(listens());
  EXPECT_LT(lines.count(), 100U) << "the log stays readable";
  hostile.reset();
  EXPECT_TRUE(eventually([&] { return participant->graph().endpoints(topic, true).size() == 1; }));
  EXPECT_TRUE(eventually([&] { return subscription.count("mismatched") == 0; }));
  EXPECT_TRUE(listens());
}

INSTANTIATE_TEST_SUITE_P(, HostileParticipants, ::testing::Values(Middleware::FastDds, Middleware::Cyclone),
                         middleware_name);

}  // namespace
}  // namespace ros2::testing

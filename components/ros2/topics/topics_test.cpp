// SPDX-License-Identifier: Apache-2.0
#include "topics_test_support.hpp"

namespace ros2::testing {
namespace {

TEST_P(Topics, SamplesOfAPublisherOfRos2Arrive) {
  RunningTask subscription("ros2::Subscription", "listener");
  subscription.run(properties("std_msgs/msg/String"));
  Reader reader(subscription);
  peer->advertise({"/chatter", "std_msgs/msg/String", kStringHash, {}});
  ASSERT_TRUE(eventually([&] { return peer->subscriptions() == 1 && subscription.count("matched") == 1; }));
  for (int i = 0; i < 5; ++i)
    peer->publish(text_message("hello " + std::to_string(i)));
  EXPECT_EQ(reader.read(5), (Texts{"hello 0", "hello 1", "hello 2", "hello 3", "hello 4"}));
  EXPECT_EQ(subscription.count("received"), 5U);
}

TEST_P(Topics, SamplesArriveAtASubscriptionOfRos2) {
  RunningTask publisher("ros2::Publisher", "talker");
  publisher.run(properties("std_msgs/msg/String"));
  Writer<> writer(publisher);
  peer->subscribe({"/chatter", "std_msgs/msg/String", kStringHash, {}});
  ASSERT_TRUE(eventually([&] { return peer->publishers() == 1 && publisher.count("matched") == 1; }));
  EXPECT_EQ(peer->user_data_of_publisher(), std::string("typehash=") + kStringHash + ";");
  for (int i = 0; i < 5; ++i)
    writer.write("hello " + std::to_string(i));
  std::vector<Bytes> messages;
  ASSERT_TRUE(eventually([&] {
    for (Bytes& message : peer->take())
      messages.push_back(std::move(message));
    return messages.size() >= 5;
  }));
  for (std::size_t i = 0; i < 5; ++i)
    EXPECT_EQ(text_of(messages[i]), "hello " + std::to_string(i));
  EXPECT_EQ(publisher.count("sent"), 5U);
}

TEST_P(Topics, ALargeSampleArrivesWhole) {
  RunningTask subscription("ros2::Subscription", "listener");
  subscription.run(properties("std_msgs/msg/String"));
  Reader reader(subscription);
  peer->advertise({});
  ASSERT_TRUE(eventually([&] { return peer->subscriptions() == 1 && subscription.count("matched") == 1; }));
  const std::string large(3'000'000, 'x');
  peer->publish(text_message(large));
  EXPECT_EQ(reader.read(1), Texts{large});
}

TEST_P(Topics, TasksAreNodesForOthers) {
  RunningTask subscription("ros2::Subscription", "front.camera");
  RunningTask publisher("ros2::Publisher", "talker");
  subscription.run(properties("std_msgs/msg/String"));
  auto values = properties("std_msgs/msg/String");
  values["node"] = "/robot/mouth";
  publisher.run(values);
  const auto names = [&] {
    std::vector<std::string> all;
    for (const auto& participant : peer->others()) {
      for (const auto& node : participant.nodes) {
        all.push_back(full_name(node) + " " + std::to_string(node.publishers.size()) + " " +
                      std::to_string(node.subscriptions.size()));
      }
    }
    return all;
  };
  EXPECT_TRUE(eventually([&] { return names().size() == 2; }));
  EXPECT_THAT(names(), ElementsAre("/front_camera 0 1", "/robot/mouth 1 0"));
  ASSERT_TRUE(subscription.task().stop(soon()));
  ASSERT_TRUE(subscription.task().cleanup(soon()));
  EXPECT_TRUE(eventually([&] { return names() == std::vector<std::string>{"/robot/mouth 1 0"}; }));
}

TEST_P(Topics, TasksAreNodesForOthersOfBeforeIron) {
  RunningTask subscription("ros2::Subscription", "listener");
  subscription.run(properties("std_msgs/msg/String"));
  const auto knows = [](Peer& other, std::size_t nodes) {
    return eventually([&] {
      const auto others = other.others();
      return others.size() == 1 && others.front().nodes.size() == nodes;
    });
  };
  EXPECT_TRUE(knows(*peer, 1));
  EXPECT_EQ(peer->misread(), 0U);
  auto old = GetParam() == Middleware::FastDds ? make_fast_peer_before_iron(own_domain())
                                               : make_cyclone_peer_before_iron(own_domain());
  EXPECT_TRUE(knows(*old, 1));
  EXPECT_TRUE(eventually([&] { return !peer->others().empty() && peer->misread() > 0; }));
  RunningTask publisher("ros2::Publisher", "talker");
  publisher.run(properties("std_msgs/msg/String"));
  EXPECT_TRUE(knows(*old, 2));
  EXPECT_EQ(old->misread(), 0U) << "it would take gigabytes for one";
  old.reset();
  EXPECT_TRUE(knows(*peer, 2)) << "those of before Iron have left";
}

TEST_P(Topics, OnlyALatchedTopicHasSamplesFromBeforeTheStart) {
  for (const bool latched : {false, true}) {
    auto values = advertise(latched);
    RunningTask subscription("ros2::Subscription", "listener");
    values["depth"] = 2;
    ASSERT_TRUE(subscription.configure(values));
    Reader reader(subscription);
    ASSERT_TRUE(eventually([&] { return peer->subscriptions() == 1 && subscription.count("matched") == 1; }));
    for (std::uint64_t i = 1; i <= 3; ++i) {
      peer->publish(text_message("early " + std::to_string(i)));
      ASSERT_TRUE(eventually([&] { return subscription.count("early") == i; }));
    }
    ASSERT_TRUE(subscription.task().start(soon()));
    peer->publish(text_message("late"));
    const Texts expected = latched ? Texts{"early 2", "early 3", "late"} : Texts{"late"};
    EXPECT_EQ(reader.read(expected.size()), expected);
  }
}

/// A task starts before the transition commits; what it writes until then reaches nobody.
TEST_P(Topics, SamplesOfALatchedTopicWaitForTheCommit) {
  for (const bool latched : {false, true}) {
    RunningTask subscription("ros2::Subscription", "listener");
    ASSERT_TRUE(subscription.configure(advertise(latched)));
    Commit commit;
    Reader reader(subscription, commit);
    ASSERT_TRUE(eventually([&] { return peer->subscriptions() == 1 && subscription.count("matched") == 1; }));
    peer->publish(text_message("before the start"));
    ASSERT_TRUE(eventually([&] { return subscription.count("early") == 1; }));
    ASSERT_TRUE(subscription.task().start(soon()));
    peer->publish(text_message("before the commit"));
    ASSERT_TRUE(eventually([&] { return subscription.count("early") == 2; }));
    EXPECT_EQ(subscription.count("received"), 0U);
    commit.happen();
    EXPECT_EQ(reader.read(), latched ? Texts({"before the start", "before the commit"}) : Texts());
    peer->publish(text_message("now"));
    EXPECT_EQ(reader.read(1), Texts({"now"}));
    EXPECT_EQ(subscription.count("received"), latched ? 3U : 1U);
  }
}

TEST_P(Topics, ALatchedTopicHasItsLastSampleForThoseThatComeLater) {
  auto values = properties("std_msgs/msg/String");
  values["durability"] = "transient_local";
  values["depth"] = 1;
  RunningTask publisher("ros2::Publisher", "map");
  publisher.run(values);
  Writer<> writer(publisher);
  writer.write("first");
  writer.write("last");
  ASSERT_TRUE(eventually([&] { return publisher.count("sent") == 2; }));
  Quality quality;
  quality.durability = segue::ros2::Durability::TransientLocal;
  peer->subscribe({"/chatter", "std_msgs/msg/String", "", quality});
  std::vector<Bytes> messages;
  ASSERT_TRUE(eventually([&] { return !(messages = peer->take()).empty(); }));
  EXPECT_EQ(text_of(messages.front()), "last");
}

TEST_P(Topics, WhatHasOutlivedItsLifespanIsNotDelivered) {
  constexpr std::chrono::milliseconds kLifespan{50};
  auto values = properties("std_msgs/msg/String");
  values["durability"] = "transient_local";
  values["lifespan"] = "50ms";
  RunningTask publisher("ros2::Publisher", "map");
  publisher.run(values);
  Writer<> writer(publisher);
  writer.write("old");
  ASSERT_TRUE(eventually([&] { return publisher.count("sent") == 1; }));
  const auto sent = segue::monotonic_now();
  ASSERT_TRUE(eventually([&] { return segue::monotonic_now() > sent + 2 * kLifespan; }));
  Quality quality;
  quality.durability = segue::ros2::Durability::TransientLocal;
  peer->subscribe({"/chatter", "std_msgs/msg/String", "", quality});
  std::vector<Bytes> messages;
  ASSERT_TRUE(eventually([&] {
    writer.write("new");
    return !(messages = peer->take()).empty();
  }));
  EXPECT_EQ(text_of(messages.front()), "new");
}

TEST_P(Topics, WhatIsStoppedPublishesNothing) {
  RunningTask publisher("ros2::Publisher", "talker");
  publisher.run(properties("std_msgs/msg/String"));
  Writer<> writer(publisher);
  peer->subscribe({});
  ASSERT_TRUE(eventually([&] { return peer->publishers() == 1 && publisher.count("matched") == 1; }));
  writer.write("before");
  ASSERT_TRUE(eventually([&] { return publisher.count("sent") == 1; }));
  ASSERT_TRUE(publisher.task().stop(soon()));
  writer.write("stopped");
  EXPECT_EQ(publisher.count("sent"), 1U);
  ASSERT_TRUE(publisher.task().start(soon()));
  EXPECT_TRUE(eventually([&] { return publisher.count("sent") == 2; })) << "the connection has kept it";
}

TEST_P(Topics, WhatExceedsABoundOfItsMessageIsNotSent) {
  const segue::testing::TemporaryFiles folder;
  folder.write("test_msgs/msg/Label.msg", "string<=5 text\n");
  auto values = properties("test_msgs/msg/Label");
  values["interfaces"] = segue::type::Value::list({folder.folder().string()});
  RunningTask publisher("ros2::Publisher", "labels");
  publisher.run(values);
  Writer<test_msgs::Label> writer(publisher);
  peer->subscribe({"/chatter", "test_msgs/msg/Label", "", {}});
  ASSERT_TRUE(eventually([&] { return peer->publishers() == 1 && publisher.count("matched") == 1; }));
  writer.write("longer");
  writer.write("short");
  std::vector<Bytes> messages;
  ASSERT_TRUE(eventually([&] { return !(messages = peer->take()).empty(); }));
  EXPECT_EQ(text_of(messages.front()), "short");
  EXPECT_EQ(publisher.count("refused"), 1U);
  EXPECT_EQ(publisher.count("sent"), 1U);
}

INSTANTIATE_TEST_SUITE_P(, Topics, ::testing::Values(Middleware::FastDds, Middleware::Cyclone),
                         middleware_name);

}  // namespace
}  // namespace ros2::testing

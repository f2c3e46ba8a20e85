// SPDX-License-Identifier: Apache-2.0
// Peers that do not fit, that send wrong bytes, or that come and go.
#include "topics_test_support.hpp"

namespace ros2::testing {
namespace {

class TopicFaults : public ::testing::Test {
 protected:
  std::unique_ptr<Peer> fast = make_fast_peer(own_domain());
  std::unique_ptr<Peer> cyclone = make_cyclone_peer(own_domain());

  static std::vector<std::string> mismatches(RunningTask& task) {
    const auto all = task.task().call("mismatches", {}, soon());
    std::vector<std::string> texts;
    if (all) {
      for (const auto& one : all->as_list())
        texts.push_back(one.as_string());
    }
    return texts;
  }
  static bool eventually_says(RunningTask& task, const Texts& expected) {
    const bool says = eventually([&] { return mismatches(task) == expected; });
    EXPECT_TRUE(says) << ::testing::PrintToString(mismatches(task));
    return says;
  }
};

TEST_F(TopicFaults, QualityThatDoesNotMatchIsSaid) {
  RunningTask subscription("ros2::Subscription", "listener");
  subscription.run(properties("std_msgs/msg/String"));
  for (auto* peer : {fast.get(), cyclone.get()}) {
    Quality quality;
    quality.reliability = segue::ros2::Reliability::BestEffort;
    peer->advertise({"/chatter", "std_msgs/msg/String", kStringHash, quality});
    peer->announce("talker");
    EXPECT_TRUE(
        eventually_says(subscription, {"node /talker publishes /chatter, but reliability: best_effort is "
                                       "offered, reliable is requested"}));
    EXPECT_EQ(subscription.count("mismatched"), 1U);
    EXPECT_EQ(subscription.count("matched"), 0U);
    peer->advertise({"/chatter", "std_msgs/msg/String", kStringHash, {}});
    EXPECT_TRUE(eventually_says(subscription, {}));
    EXPECT_TRUE(eventually([&] { return subscription.count("matched") >= 1; }));
    peer->advertise({"/elsewhere", "std_msgs/msg/String", kStringHash, {}});
    EXPECT_TRUE(eventually([&] { return subscription.count("matched") == 0; }));
  }
}

TEST_F(TopicFaults, SubscriptionsThatRequestMoreThanIsOfferedAreSaid) {
  RunningTask publisher("ros2::Publisher", "talker");
  publisher.run(properties("std_msgs/msg/String"));
  Quality quality;
  quality.durability = segue::ros2::Durability::TransientLocal;
  quality.deadline = std::chrono::milliseconds(100);
  for (auto* peer : {fast.get(), cyclone.get()}) {
    peer->subscribe({"/chatter", "std_msgs/msg/String", "", quality});
    peer->announce("listener");
    EXPECT_TRUE(
        eventually_says(publisher, {"node /listener subscribes to /chatter, but durability: volatile is "
                                    "offered, transient_local is requested and deadline: infinite is "
                                    "offered, 100ms is requested"}));
    peer->subscribe({"/elsewhere", "std_msgs/msg/String", "", {}});
    EXPECT_TRUE(eventually_says(publisher, {}));
  }
}

TEST_F(TopicFaults, AnotherTypeOrDefinitionIsSaid) {
  RunningTask subscription("ros2::Subscription", "listener");
  subscription.run(properties("std_msgs/msg/String"));
  fast->advertise({"/chatter", "std_msgs/msg/Int32", "", {}});
  EXPECT_TRUE(
      eventually_says(subscription, {"a program that is not a node publishes /chatter, but its type is "
                                     "std_msgs/msg/Int32, here it is std_msgs/msg/String"}));
  EXPECT_EQ(subscription.count("matched"), 0U);
  fast.reset();
  EXPECT_TRUE(eventually_says(subscription, {}));
  cyclone->advertise({"/chatter", "std_msgs/msg/String", "RIHS01_0123", {}});
  cyclone->announce("talker");
  EXPECT_TRUE(eventually_says(
      subscription,
      {std::string("node /talker publishes /chatter, but its definition of std_msgs/msg/String is "
                   "another one (RIHS01_0123, here ") +
       kStringHash + ")"}));
}

TEST_F(TopicFaults, MalformedMessagesAreCountedAndDropped) {
  RunningTask subscription("ros2::Subscription", "listener");
  subscription.run(properties("std_msgs/msg/String"));
  Reader reader(subscription);
  std::uint64_t corrupt = 0;
  for (auto* peer : {fast.get(), cyclone.get()}) {
    peer->advertise({});
    ASSERT_TRUE(eventually([&] { return peer->subscriptions() == 1 && subscription.count("matched") == 1; }));
    const Bytes whole = text_message("hello");
    // DDS fills messages to a multiple of four bytes, with zeros, as is the last byte of a text.
    for (std::size_t size = 4; size <= 12; ++size, ++corrupt)
      peer->publish({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)});
    Bytes huge = whole;
    std::fill(huge.begin() + 4, huge.begin() + 8, std::byte{0xff});
    peer->publish(huge);
    peer->publish(Bytes(1000, std::byte{0x5a}));
    corrupt += 2;
    peer->publish(whole);
    EXPECT_EQ(reader.read(1), Texts{"hello"});
    EXPECT_EQ(subscription.count("corrupt"), corrupt);
    peer->advertise({"/elsewhere", "std_msgs/msg/String", "", {}});
    ASSERT_TRUE(eventually([&] { return subscription.count("matched") == 0; }));
  }
}

TEST_F(TopicFaults, APeerThatComesAndGoesAHundredTimesIsFoundEachTime) {
  RunningTask subscription("ros2::Subscription", "listener");
  subscription.run(properties("std_msgs/msg/String"));
  Reader reader(subscription);
  for (int i = 0; i < 100; ++i) {
    Peer& peer = i % 2 == 0 ? *fast : *cyclone;
    peer.advertise({});
    ASSERT_TRUE(eventually([&] { return peer.subscriptions() == 1 && subscription.count("matched") == 1; }))
        << i;
    peer.publish(text_message(std::to_string(i)));
    ASSERT_EQ(reader.read(1), Texts{std::to_string(i)});
    peer.advertise({"/elsewhere", "std_msgs/msg/String", "", {}});
    ASSERT_TRUE(eventually([&] { return subscription.count("matched") == 0; })) << i;
  }
}

TEST_F(TopicFaults, ATaskThatComesAndGoesLeavesNothing) {
  cyclone->advertise({});
  fast->subscribe({"/answers", "std_msgs/msg/String", "", {}});
  RunningTask subscription("ros2::Subscription", "listener");
  RunningTask publisher("ros2::Publisher", "talker");
  auto answers = properties("std_msgs/msg/String");
  answers["topic"] = "answers";
  for (int i = 0; i < 10; ++i) {
    subscription.run(properties("std_msgs/msg/String"));
    publisher.run(answers);
    ASSERT_TRUE(eventually([&] { return cyclone->subscriptions() == 1 && fast->publishers() == 1; })) << i;
    for (auto* task : {&subscription, &publisher}) {
      ASSERT_TRUE(task->task().stop(soon()));
      ASSERT_TRUE(task->task().cleanup(soon()));
    }
    ASSERT_TRUE(eventually([&] { return cyclone->subscriptions() == 0 && fast->publishers() == 0; })) << i;
  }
}

/// Returns the error of a Subscription with this property in place of the usual one.
std::string refusal(const std::string& name, segue::type::Value value) {
  RunningTask subscription("ros2::Subscription", "listener");
  ValueMap values = properties("std_msgs/msg/String");
  values[name] = std::move(value);
  const auto done = subscription.configure(values);
  EXPECT_EQ(subscription.task().state(), segue::TaskState::PreOperational);
  return done ? std::string() : segue::to_string(done.error());
}

TEST_F(TopicFaults, WrongPropertiesAreRefusedWithAReason) {
  EXPECT_THAT(refusal("topic", "/a b"), HasSubstr("'/a b' is not a valid name of a topic"));
  EXPECT_THAT(refusal("topic", ""), HasSubstr("'' is not a valid name of a topic"));
  EXPECT_THAT(refusal("type", "std_msgs/msg/Strin"), HasSubstr("String"));
  EXPECT_THAT(refusal("type", "nothing"), HasSubstr("nothing"));
  EXPECT_THAT(refusal("reliability", "often"), HasSubstr("expected reliable or best_effort"));
  EXPECT_THAT(refusal("durability", "often"), HasSubstr("expected volatile or transient_local"));
  EXPECT_THAT(refusal("liveliness", "often"), HasSubstr("expected automatic or manual_by_topic"));
  EXPECT_THAT(refusal("deadline", "-1s"), HasSubstr("must not be negative"));
  EXPECT_THAT(refusal("domain", 233), HasSubstr("domain 233 does not exist"));
  EXPECT_THAT(refusal("discovery", "world"), HasSubstr("expected localhost, subnet or off"));
  EXPECT_THAT(refusal("node", "a b"), HasSubstr("'a b' is not a valid name of a node"));
  ::setenv("ROS_DOMAIN_ID", "many", 1);
  EXPECT_THAT(refusal("domain", -1), HasSubstr("$ROS_DOMAIN_ID is 'many'"));
  ::unsetenv("ROS_DOMAIN_ID");
}

TEST_F(TopicFaults, TasksOfOneProcessHaveTheSameSettings) {
  RunningTask first("ros2::Subscription", "first");
  first.run(properties("std_msgs/msg/String"));
  EXPECT_THAT(refusal("domain", std::int64_t{own_domain() % 200 + 2}), HasSubstr("with other settings"));
  EXPECT_THAT(refusal("type", "std_msgs/msg/Int32"),
              HasSubstr("a task of this process has topic /chatter with type std_msgs/msg/String"));
}

TEST_F(TopicFaults, DeadlinesThatAreMissedAreCounted) {
  auto values = properties("std_msgs/msg/String");
  values["deadline"] = "20ms";
  RunningTask subscription("ros2::Subscription", "listener");
  subscription.run(values);
  Quality quality;
  quality.deadline = std::chrono::milliseconds(10);
  fast->advertise({"/chatter", "std_msgs/msg/String", "", quality});
  ASSERT_TRUE(eventually([&] { return fast->subscriptions() == 1; }));
  fast->publish(text_message("once"));
  EXPECT_TRUE(eventually([&] { return subscription.count("missed") >= 2; }));
}

/// A publisher that is alive by what it publishes only, and does so once.
TEST_F(TopicFaults, LossesOfLivelinessAreCountedOnBothSides) {
  auto values = properties("std_msgs/msg/String");
  values["liveliness"] = "manual_by_topic";
  values["lease"] = "50ms";
  RunningTask subscription("ros2::Subscription", "listener");
  subscription.run(values);
  Quality quality;
  quality.liveliness = segue::ros2::Liveliness::ManualByTopic;
  quality.lease = std::chrono::milliseconds(50);
  std::uint64_t lost = 0;
  for (auto* peer : {fast.get(), cyclone.get()}) {
    peer->advertise({"/chatter", "std_msgs/msg/String", "", quality});
    ASSERT_TRUE(eventually([&] { return peer->subscriptions() == 1 && subscription.count("matched") == 1; }));
    peer->publish(text_message("once"));
    EXPECT_TRUE(eventually([&] { return subscription.count("missed") > lost; }));
    peer->advertise({"/elsewhere", "std_msgs/msg/String", "", {}});
    ASSERT_TRUE(eventually([&] { return subscription.count("matched") == 0; }));
    lost = subscription.count("missed");
  }
  values["topic"] = "/words";
  RunningTask publisher("ros2::Publisher", "talker");
  publisher.run(values);
  Writer<> writer(publisher);
  writer.write("once");
  EXPECT_TRUE(eventually([&] { return publisher.count("missed") > 0; }));
}

}  // namespace
}  // namespace ros2::testing

// SPDX-License-Identifier: Apache-2.0
#include "link_test_support.hpp"

namespace gateway::testing {
namespace {

TEST(GatewayNames, AreThoseOfRos) {
  EXPECT_EQ(dds_topic_name("scan").value(), "rt/scan");
  EXPECT_EQ(dds_topic_name("/robot/scan").value(), "rt/robot/scan");
  for (const char* wrong : {"", "/", "a//b", "a/", "a b", "a-b", "//a"})
    EXPECT_FALSE(dds_topic_name(wrong)) << wrong;
  EXPECT_EQ(dds_type_name(""), "std_msgs::msg::dds_::Empty_");
  EXPECT_EQ(dds_type_name("/double"), "segue::msg::dds_::double_");
  EXPECT_EQ(dds_type_name("/base/samples/Pose"), "base::samples::msg::dds_::Pose_");
  EXPECT_EQ(dds_type_name("/sensor_msgs/msg/Imu"), "sensor_msgs::msg::dds_::Imu_");
  EXPECT_EQ(dds_type_name("/sensor_msgs/Imu"), "sensor_msgs::msg::dds_::Imu_");
  const std::string vector = dds_type_name("/std/vector</double>");
  EXPECT_THAT(vector, ::testing::MatchesRegex("segue::msg::dds_::std_vector_double_[0-9a-f]+_"));
  EXPECT_NE(vector, dds_type_name("/std/vector</double[1]>"));
}

TEST_F(GatewayLink, SamplesTravelWithinAProcess) {
  Running receiver("gateway::Receiver", properties(kDomain, topic, name_of<Text>(), "buffer", 100));
  Sink<Text> sink(receiver, kPlenty);
  Running sender("gateway::Sender", properties(kDomain, topic, name_of<Text>(), "buffer", 100));
  Source<Text> source(sender, kPlenty);
  ASSERT_TRUE(sender.has_matched(1));
  ASSERT_TRUE(receiver.has_matched(1));
  for (std::uint64_t number = 1; number <= 50; ++number)
    source.write(number);
  EXPECT_EQ(sink.read(50), numbers(1, 50));
  EXPECT_EQ(sender.count("sent"), 50U);
  EXPECT_EQ(receiver.count("received"), 50U);
  EXPECT_EQ(receiver.count("bytes"), sender.count("bytes"));
}

/// Writes through shared memory, and reads the same way and within the process.
template <class T>
void expect_samples_between_shared_memories(const std::string& topic) {
  const segue::sample_link::shared_test::Pair memories(
      {std::size_t{1} << 16, std::size_t{1} << 26, std::size_t{1} << 24});
  const ValueMap values = properties(kDomain, topic, name_of<T>(), "buffer", 100);
  Running receiver("gateway::Receiver", values);
  Sink<T> within(receiver, kPlenty);
  Sink<T> beyond;
  const auto to_reader = memories.connect(receiver.out(), beyond.port, policy(BufferKind::Buffer, 100));
  Running sender("gateway::Sender", values);
  Source<T> source;
  const auto from_writer = memories.connect(source.port, sender.in(), policy(BufferKind::Buffer, 100));
  ASSERT_TRUE(to_reader.ok && from_writer.ok);
  ASSERT_TRUE(sender.has_matched(1));
  for (std::uint64_t number = 1; number <= 60; ++number)
    ASSERT_EQ(source.write(number, number * 97), segue::task::WriteResult::Written);
  EXPECT_EQ(within.read(60), numbers(1, 60));
  EXPECT_EQ(beyond.read(60), numbers(1, 60));
  EXPECT_EQ(sender.count("sent"), 60U);
  EXPECT_EQ(receiver.count("received"), 60U);
  EXPECT_EQ(receiver.count("bytes"), sender.count("bytes"));
  EXPECT_EQ(from_writer.output->counters().read, 60U);
  EXPECT_EQ(to_reader.output->counters().read, 60U);
}

TEST_F(GatewayLink, SamplesTravelFromSharedMemoryToSharedMemory) {
  expect_samples_between_shared_memories<Cloud>(topic + "_cloud");
  expect_samples_between_shared_memories<Text>(topic + "_text");
  expect_samples_between_shared_memories<Image>(topic + "_image");
  expect_samples_between_shared_memories<Pose>(topic + "_pose");
}

TEST_F(GatewayLink, NestedVectorsTravelBetweenProcesses) {
  Peer peer = receiving<Cloud>(topic, "buffer", 1000);
  Running sender("gateway::Sender", properties(kDomain, topic, name_of<Cloud>(), "buffer", 1000));
  Source<Cloud> source(sender, kPlenty);
  ASSERT_TRUE(have_matched(sender, peer));
  for (std::uint64_t number = 1; number <= 200; ++number)
    source.write(number, number * 31);
  EXPECT_TRUE(eventually([&] { return peer.count("received") == 200; }));
  EXPECT_EQ(peer.ask("samples"), "200 whole, 0 broken, in order, last 200");
}

TEST_F(GatewayLink, SamplesWithoutAValueTravel) {
  Running receiver("gateway::Receiver", properties(kDomain, topic, "", "buffer", 100));
  Running sender("gateway::Sender", properties(kDomain, topic, "", "buffer", 100));
  Source<Pose> source(sender, kPlenty);
  ASSERT_TRUE(sender.has_matched(1));
  source.write(1);
  EXPECT_TRUE(eventually([&] { return receiver.count("received") == 1; }));
  EXPECT_EQ(sender.count("bytes"), 5U);
}

TEST_F(GatewayLink, SamplesTravelBetweenProcessesWholeAndInOrder) {
  for (const char* policy : {"buffer", "circular_buffer"}) {
    const std::string own = topic + policy;
    Peer peer = receiving<Text>(own, policy, 1000);
    Running sender("gateway::Sender", properties(kDomain, own, name_of<Text>(), policy, 1000));
    Source<Text> source(sender, kPlenty);
    ASSERT_TRUE(have_matched(sender, peer));
    for (std::uint64_t number = 1; number <= 500; ++number)
      source.write(number, number * 7);
    EXPECT_TRUE(eventually([&] { return peer.count("received") == 500; }));
    EXPECT_EQ(peer.ask("samples"), "500 whole, 0 broken, in order, last 500") << policy;
    EXPECT_EQ(sender.count("lost") + sender.count("refused") + peer.count("lost"), 0U);
  }
}

TEST_F(GatewayLink, TheNewestValueArrivesHoweverFastItChanges) {
  Peer peer = receiving<Pose>(topic);
  Running sender("gateway::Sender", properties(kDomain, topic, name_of<Pose>()));
  Source<Pose> source(sender, policy(BufferKind::Data));
  ASSERT_TRUE(have_matched(sender, peer));
  // Where the first ones are overwritten before the reader has heard of the writer, it cannot count them.
  source.write(1);
  ASSERT_TRUE(eventually([&] { return peer.count("received") == 1; }));
  for (std::uint64_t number = 2; number <= 20'000; ++number)
    source.write(number);
  EXPECT_TRUE(eventually([&] { return peer.ask("samples").ends_with("last 20000"); })) << peer.ask("samples");
  EXPECT_TRUE(
      eventually([&] { return peer.count("received") + peer.count("lost") >= sender.count("sent"); }));
  EXPECT_EQ(peer.count("received") + peer.count("lost"), sender.count("sent"));
}

TEST_F(GatewayLink, AReaderThatComesLaterGetsTheLastValueIfItWants) {
  for (const bool init : {true, false}) {
    const std::string own = topic + (init ? "_init" : "_plain");
    Running sender("gateway::Sender", properties(kDomain, own, name_of<Pose>(), "data", 1, init));
    Source<Pose> source(sender, policy(BufferKind::Data));
    source.write(1);
    ASSERT_TRUE(eventually([&] { return sender.count("sent") == 1; }));
    Running receiver("gateway::Receiver");
    ASSERT_TRUE(receiver.configure(properties(kDomain, own, name_of<Pose>(), "data", 1, init)));
    Sink<Pose> sink(receiver, kPlenty);
    ASSERT_TRUE(receiver.task().start(soon()));
    ASSERT_TRUE(sender.has_matched(1));
    if (!init) source.write(2);
    EXPECT_EQ(sink.read(1), init ? numbers(1, 1) : numbers(2, 2));
    EXPECT_EQ(sender.count("lost"), init ? 0U : 1U) << "nobody was there";
  }
}

TEST_F(GatewayLink, LargeSamplesArriveWhole) {
  Peer peer = receiving<Image>(topic, "buffer", 4);
  Running sender("gateway::Sender", properties(kDomain, topic, name_of<Image>(), "buffer", 4));
  Source<Image> source(sender, policy(BufferKind::Buffer, 4));
  ASSERT_TRUE(have_matched(sender, peer));
  std::uint64_t number = 0;
  for (const std::size_t bytes : {1'000'000U, 10'000'000U, 10'000'000U, 100'000'000U}) {
    source.write(++number, bytes);
    ASSERT_TRUE(eventually([&] { return peer.count("received") + sender.count("refused") >= number; }));
  }
  EXPECT_EQ(peer.ask("samples"), "4 whole, 0 broken, in order, last 4");
  EXPECT_EQ(peer.count("corrupt"), 0U);
}

TEST_F(GatewayLink, ASenderOfABufferStopsSoonAfterItsSamplesHaveArrived) {
  Peer peer = receiving<Pose>(topic, "buffer", 100);
  Running sender("gateway::Sender", properties(kDomain, topic, name_of<Pose>(), "buffer", 100));
  Source<Pose> source(sender, kPlenty);
  ASSERT_TRUE(have_matched(sender, peer));
  std::vector<segue::Duration> stops;
  for (std::uint64_t number = 2; number <= 14; number += 2) {
    source.write(number - 1);  // the first sample after a pause asks for an acknowledgement itself
    source.write(number);
    ASSERT_TRUE(eventually([&] { return peer.count("received") == number; }));
    const auto begin = segue::RealClock::instance().now();
    ASSERT_TRUE(sender.task().stop(soon()));
    stops.emplace_back(segue::RealClock::instance().now() - begin);
    ASSERT_TRUE(sender.task().start(soon()));
  }
  std::ranges::sort(stops);  // a busy computer delays some of them
  EXPECT_LT(stops.at(stops.size() / 2), std::chrono::milliseconds(100));
}

TEST_F(GatewayLink, WhatOutrunsABufferIsRefusedAndCounted) {
  Peer peer = receiving<Image>(topic, "buffer", 2);
  Running sender("gateway::Sender", properties(kDomain, topic, name_of<Image>(), "buffer", 2));
  Source<Image> source(sender, policy(BufferKind::Buffer, 2));
  ASSERT_TRUE(have_matched(sender, peer));
  constexpr std::uint64_t kCount = 200;
  std::uint64_t refused_here = 0;
  for (std::uint64_t number = 1; number <= kCount; ++number)
    refused_here += source.write(number, 500'000) == segue::task::WriteResult::Refused ? 1 : 0;
  ASSERT_TRUE(
      eventually([&] { return sender.count("sent") + sender.count("refused") + refused_here == kCount; }));
  EXPECT_TRUE(eventually([&] { return sender.count("unacknowledged") == 0; }));
  EXPECT_EQ(peer.count("received") + peer.count("lost") + peer.count("corrupt"), sender.count("sent"));
  EXPECT_EQ(peer.count("lost") + sender.count("lost"), 0U) << "a reliable buffer loses nothing";
  EXPECT_THAT(peer.ask("samples"), HasSubstr(" 0 broken, in order"));
}

TEST_F(GatewayLink, WhatAReaderThatStandsStillKeepsFromBeingSentIsRefusedAndCounted) {
  Peer peer = receiving<Image>(topic, "buffer", 2);
  Running sender("gateway::Sender", properties(kDomain, topic, name_of<Image>(), "buffer", 2));
  Source<Image> source(sender, policy(BufferKind::Buffer, 2));
  ASSERT_TRUE(have_matched(sender, peer));
  source.write(1, 100'000);
  ASSERT_TRUE(eventually([&] { return peer.count("received") == 1; }));
  peer.signal(SIGSTOP);
  std::uint64_t written = 1;
  std::uint64_t refused_here = 0;
  // The sender may be slow to take what is written, so that the port refuses before the sender has to.
  const bool refuses = eventually([&] {
    refused_here += source.write(++written, 1'000'000) == segue::task::WriteResult::Refused ? 1 : 0;
    return sender.count("refused") > 0;
  });
  peer.signal(SIGCONT);
  EXPECT_TRUE(refuses);
  EXPECT_TRUE(
      eventually([&] { return sender.count("sent") + sender.count("refused") + refused_here == written; }));
  EXPECT_TRUE(eventually([&] { return sender.count("unacknowledged") == 0; }));
  EXPECT_EQ(peer.count("received") + sender.count("lost"), sender.count("sent"));
  EXPECT_THAT(peer.ask("samples"), HasSubstr(" 0 broken, in order"));
}

TEST_F(GatewayLink, FiftyIdleTasksDoNotPoll) {
  std::vector<std::unique_ptr<Running>> tasks;
  for (int i = 0; i < 25; ++i) {
    const auto values = properties(kDomain, topic + "_" + std::to_string(i), name_of<Pose>(), "buffer", 10);
    tasks.push_back(std::make_unique<Running>("gateway::Receiver", values));
    tasks.push_back(std::make_unique<Running>("gateway::Sender", values));
    ASSERT_TRUE(tasks.back()->has_matched(1));
  }
  const std::clock_t before = std::clock();
  std::this_thread::sleep_for(std::chrono::seconds(1));  // what is measured is what a second takes
  const double used = static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
  std::printf("50 idle link tasks: %.1f ms of processor time in a second\n", 1000 * used);
  EXPECT_LT(used, 0.1);
}

TEST_F(GatewayLink, WhatAReaderThatDiesHasNotAcknowledgedIsCountedAsLost) {
  Peer peer = receiving<Text>(topic, "buffer", 1000);
  Running sender("gateway::Sender", properties(kDomain, topic, name_of<Text>(), "buffer", 1000));
  Source<Text> source(sender, kPlenty);
  ASSERT_TRUE(have_matched(sender, peer));
  peer.signal(SIGKILL);
  for (std::uint64_t number = 1; number <= 10; ++number)
    source.write(number);
  ASSERT_TRUE(eventually([&] { return sender.count("matched") == 0; })) << "the lease ends";
  EXPECT_EQ(sender.count("sent"), 10U);
  EXPECT_EQ(sender.count("lost"), 10U);
  source.write(11);
  EXPECT_TRUE(eventually([&] { return sender.count("lost") == 11; })) << "nobody is there";
  EXPECT_EQ(sender.count("unacknowledged"), 0U);
}

TEST_F(GatewayLink, ASenderFeedsSeveralProcesses) {
  Peer one = receiving<Pose>(topic, "buffer", 100);
  Peer other = receiving<Pose>(topic, "buffer", 100);
  Running sender("gateway::Sender", properties(kDomain, topic, name_of<Pose>(), "buffer", 100));
  Source<Pose> source(sender, kPlenty);
  ASSERT_TRUE(sender.has_matched(2) && have_matched(sender, one) && have_matched(sender, other));
  for (std::uint64_t number = 1; number <= 20; ++number)
    source.write(number);
  for (Peer* peer : {&one, &other}) {
    EXPECT_TRUE(eventually([&] { return peer->count("received") == 20; }));
    EXPECT_EQ(peer->ask("samples"), "20 whole, 0 broken, in order, last 20");
  }
}

TEST_F(GatewayLink, SamplesThatComeBeforeTheStartWaitByPolicy) {
  Running receiver("gateway::Receiver");
  ASSERT_TRUE(receiver.configure(properties(kDomain, topic, name_of<Pose>(), "circular_buffer", 3)));
  Sink<Pose> sink(receiver, kPlenty);
  Running sender("gateway::Sender", properties(kDomain, topic, name_of<Pose>(), "circular_buffer", 100));
  Source<Pose> source(sender, kPlenty);
  ASSERT_TRUE(sender.has_matched(1));
  for (std::uint64_t number = 1; number <= 5; ++number)
    source.write(number);
  ASSERT_TRUE(eventually([&] { return receiver.count("lost") == 2; }));
  ASSERT_TRUE(receiver.task().start(soon()));
  EXPECT_EQ(sink.read(3), numbers(3, 5));
}

TEST_F(GatewayLink, TasksAreStoppedAndConfiguredAgain) {
  Running receiver("gateway::Receiver", properties(kDomain, topic, name_of<Pose>(), "buffer", 100));
  Running sender("gateway::Sender", properties(kDomain, topic, name_of<Pose>(), "buffer", 100));
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(receiver.task().stop(soon()));
    ASSERT_TRUE(receiver.task().cleanup(soon()));
    EXPECT_TRUE(eventually([&] { return sender.count("matched") == 0; }));
    ASSERT_TRUE(receiver.task().configure(soon()));
    ASSERT_TRUE(receiver.task().start(soon()));
    ASSERT_TRUE(sender.has_matched(1));
    Sink<Pose> sink(receiver, kPlenty);
    Source<Pose> source(sender, kPlenty);
    source.write(7);
    EXPECT_EQ(sink.read(1), numbers(7, 7));
  }
}

}  // namespace
}  // namespace gateway::testing

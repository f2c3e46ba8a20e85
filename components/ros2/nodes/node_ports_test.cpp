// SPDX-License-Identifier: Apache-2.0
// Topics of nodes as ports of their tasks.
#include "../participant/participant.hpp"
#include "../peers/managed_peer.hpp"
#include "../topics/topics_test_support.hpp"

#include <segue/base/virtual_clock.hpp>
#include <segue/task/manual_executor.hpp>

#include <support/counted_new.hpp>

#include <algorithm>
#include <thread>

namespace ros2::testing {
namespace {

using segue::TaskState;
using segue::type::Value;

constexpr const char* kText = "std_msgs/msg/String";

ValueMap node_with(const char* property, Value ports, const std::string& timeout = "60s") {
  ValueMap map;
  map.append("name", "/talker");
  map.append("domain", std::int64_t{own_domain()});
  map.append("discovery", "localhost");
  map.append("timeout", timeout);
  map.append(property, std::move(ports));
  return map;
}

ValueMap publishing(const std::string& timeout = "60s", const std::string& reliability = "reliable") {
  return node_with(
      "publishes",
      Value::map(
          {{"words",
            Value::map(
                {{"topic", "/chatter"}, {"type", kText}, {"depth", 100}, {"reliability", reliability}})}}),
      timeout);
}

ValueMap subscribing() {
  return node_with(
      "subscribes",
      Value::map({{"words", Value::map({{"topic", "/chatter"}, {"type", kText}, {"depth", 100}})}}));
}

std::string error_of(const segue::Result<void>& done) {
  return done ? std::string() : segue::to_string(done.error());
}

segue::task::OutputPortBase& output(RunningTask& task, const char* name = "words") {
  return *task.task().component().find_output(name);
}
segue::task::InputPortBase& input(RunningTask& task, const char* name = "words") {
  return *task.task().component().find_input(name);
}

/// A counter of the first port.
std::uint64_t count(RunningTask& task, const char* property, const char* counter) {
  const auto all = task.task().call("statistics", {}, soon());
  if (!all || all->find(property)->as_list().empty()) return ~std::uint64_t{0};
  return static_cast<std::uint64_t>(
      all->find(property)->as_list().front().find("counts")->find(counter)->as_int());
}

class NodePorts : public Topics {
 protected:
  /// "/talker" publishes "/chatter".
  void talk(Peer& by, const Quality& quality = {}) {
    by.advertise({"/chatter", kText, kStringHash, quality});
    by.announce("talker");
  }
  void listen() {
    peer->subscribe({"/chatter", kText, kStringHash, {}});
    peer->announce("talker");
  }
  bool is_matched() {
    return eventually([&] { return peer->subscriptions() == 1 && count(task, "publishes", "matched") >= 1; });
  }
  Texts heard(std::size_t number) {
    Texts texts;
    static_cast<void>(eventually([&] {
      for (const Bytes& message : peer->take())
        texts.push_back(text_of(message));
      return texts.size() >= number;
    }));
    return texts;
  }

  RunningTask task{"ros2::Node", "talker_node"};
};

TEST_P(NodePorts, WhatTheNodePublishesIsAnOutput) {
  talk(*peer);
  task.run(publishing());
  Reader reader(output(task));
  ASSERT_TRUE(is_matched());
  for (int i = 0; i < 5; ++i)
    peer->publish(text_message("hello " + std::to_string(i)));
  EXPECT_EQ(reader.read(5), (Texts{"hello 0", "hello 1", "hello 2", "hello 3", "hello 4"}));
  EXPECT_EQ(count(task, "publishes", "received"), 5U);
}

TEST_P(NodePorts, WhatTheNodeSubscribesToIsAnInput) {
  listen();
  task.run(subscribing());
  Writer<> writer(input(task));
  ASSERT_TRUE(
      eventually([&] { return peer->publishers() == 1 && count(task, "subscribes", "matched") == 1; }));
  for (int i = 0; i < 40; ++i) {
    Texts written;  // the node keeps the last ten
    for (int j = 0; j < 5; ++j)
      writer.write(written.emplace_back(std::to_string(5 * i + j)));
    ASSERT_EQ(heard(5), written);
  }
  EXPECT_EQ(count(task, "subscribes", "sent"), 200U);
}

TEST_P(NodePorts, CarrySamplesBetweenStartAndStopOnly) {
  talk(*peer);
  ASSERT_EQ(error_of(task.configure(publishing())), "");
  Reader reader(output(task));
  ASSERT_TRUE(is_matched());
  peer->publish(text_message("early"));
  ASSERT_TRUE(eventually([&] { return count(task, "publishes", "early") == 1; }));
  ASSERT_EQ(error_of(task.task().start(soon())), "");
  peer->publish(text_message("in between"));
  EXPECT_EQ(reader.read(1), Texts{"in between"});
  ASSERT_EQ(error_of(task.task().stop(soon())), "");
  peer->publish(text_message("late"));
  ASSERT_TRUE(eventually([&] { return count(task, "publishes", "early") == 2; }));
  EXPECT_EQ(reader.read(), Texts{});
}

TEST_P(NodePorts, ToldInShortHaveTheTopicOfTheirName) {
  talk(*peer);
  task.run(node_with("publishes", Value::map({{"chatter", kText}})));
  Reader reader(output(task, "chatter"));
  ASSERT_TRUE(is_matched());
  peer->publish(text_message("hello"));
  EXPECT_EQ(reader.read(1), Texts{"hello"});
}

TEST_P(NodePorts, AreReadyWithTheirFirstSample) {
  talk(*peer);
  auto values = publishing();
  values["ready"] = Value::list({"words"});
  ASSERT_EQ(error_of(task.configure(values)), "");
  ASSERT_TRUE(is_matched());
  std::string started = "not yet";
  std::thread starter([&] { started = error_of(task.task().start(soon())); });
  // Whether it waits by now or not, it has had no sample.
  EXPECT_EQ(task.task().state(), TaskState::Stopped);
  EXPECT_TRUE(eventually([&] {
    peer->publish(text_message("hello"));
    return task.task().state() == TaskState::Running;
  }));
  starter.join();
  EXPECT_EQ(started, "");
}

TEST_P(NodePorts, ThatGetNothingMakeTheStartFail) {
  Quality weak;
  weak.reliability = segue::ros2::Reliability::BestEffort;
  talk(*peer, weak);
  // Another task that knows the node, so that a second suffices for this one.
  RunningTask other("ros2::Subscription", "other");
  other.run(properties(kText));
  const std::string why =
      "node /talker publishes /chatter, but reliability: best_effort is offered, reliable is requested";
  ASSERT_TRUE(eventually([&] {
    const auto all = other.task().call("mismatches", {}, soon());
    return all && *all == Value::list({why});
  }));
  auto values = publishing("1s");
  values["ready"] = Value::list({"words"});
  ASSERT_EQ(error_of(task.configure(values)), "");
  EXPECT_THAT(error_of(task.task().start(soon())),
              HasSubstr("no sample has come at port 'words' (" + why + ")"));
  EXPECT_EQ(task.task().state(), TaskState::Stopped);
}

TEST_P(NodePorts, CarryNothingOfOtherNodes) {
  const auto other =
      GetParam() == Middleware::FastDds ? make_cyclone_peer(own_domain()) : make_fast_peer(own_domain());
  other->advertise({"/chatter", kText, kStringHash, {}});
  other->announce("parrot");
  talk(*peer);
  task.run(publishing());
  Reader reader(output(task));
  ASSERT_TRUE(is_matched());
  ASSERT_TRUE(eventually([&] {
    if (other->subscriptions() == 1) other->publish(text_message("parrot"));
    return count(task, "publishes", "foreign") >= 1;
  }));
  // A sample that came before the node had a name may have passed.
  reader.read();
  for (int i = 0; i < 5; ++i) {
    other->publish(text_message("parrot"));
    peer->publish(text_message(std::to_string(i)));
    EXPECT_EQ(reader.read(1), Texts{std::to_string(i)});
  }
}

TEST_P(NodePorts, SayThatAnotherNodeHasTheTopic) {
  peer->advertise({"/chatter", kText, kStringHash, {}});
  peer->announce("parrot");
  const auto talker = make_fast_peer(own_domain());
  talker->announce("talker");
  task.run(publishing());
  EXPECT_TRUE(eventually([&] {
    const auto all = task.task().call("mismatches", {}, soon());
    return all &&
           *all == Value::list({"node /parrot publishes /chatter, but port words carries what node /talker "
                                "publishes"});
  }));
}

TEST_P(NodePorts, SayThatTheTypeIsAnotherOne) {
  peer->advertise({"/chatter", "std_msgs/msg/Int32", "", {}});
  peer->announce("talker");
  task.run(publishing());
  EXPECT_TRUE(eventually([&] {
    const auto all = task.task().call("mismatches", {}, soon());
    return all &&
           *all == Value::list({"node /talker publishes /chatter, but its type is std_msgs/msg/Int32, here "
                                "it is std_msgs/msg/String"});
  }));
  EXPECT_EQ(count(task, "publishes", "matched"), 0U);
}

/// A sample that comes from the topic goes back to it.
TEST_P(NodePorts, DoNotSendSamplesRound) {
  talk(*peer);
  task.run(publishing());
  RunningTask publisher("ros2::Publisher", "echo");
  auto values = properties(kText);
  publisher.run(values);
  const auto refused = segue::sample_link::connect(output(task), publisher.in(), kPlenty);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message,
              HasSubstr("talker_node.words and echo.in are both topic /chatter of ROS 2 (domain "));
  Reader reader(output(task));
  Writer<> writer(publisher);
  ASSERT_TRUE(is_matched());
  writer.write("round");
  EXPECT_TRUE(eventually([&] { return count(task, "publishes", "foreign") == 1; }));
  peer->publish(text_message("hello"));
  EXPECT_EQ(reader.read(1), Texts{"hello"});
}

TEST_P(NodePorts, CountAndDropMalformedMessages) {
  talk(*peer);
  task.run(publishing());
  Reader reader(output(task));
  ASSERT_TRUE(is_matched());
  const Bytes whole = text_message("hello");
  for (std::size_t size = 4; size <= 12; ++size)
    peer->publish({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)});
  peer->publish(Bytes(1000, std::byte{0x5a}));
  peer->publish(whole);
  EXPECT_EQ(reader.read(1), Texts{"hello"});
  EXPECT_EQ(count(task, "publishes", "corrupt"), 10U);
}

TEST_P(NodePorts, GoOnWithANodeThatComesBack) {
  talk(*peer);
  task.run(publishing());
  Reader reader(output(task));
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(is_matched());
    ASSERT_TRUE(eventually([&] { return task.task().state() == TaskState::Running; }));
    peer->publish(text_message(std::to_string(i)));
    EXPECT_EQ(reader.read(1), Texts{std::to_string(i)});
    peer.reset();
    ASSERT_TRUE(eventually([&] { return task.task().state() == TaskState::RunTimeError; }));
    peer = GetParam() == Middleware::FastDds ? make_fast_peer(own_domain()) : make_cyclone_peer(own_domain());
    talk(*peer);
  }
}

TEST_P(NodePorts, OfManagedNodesCarrySamplesWhileTheNodeIsSilent) {
  const auto make = [] {
    return GetParam() == Middleware::FastDds ? make_fast_peer(own_domain()) : make_cyclone_peer(own_domain());
  };
  ManagedPeer node{make};
  listen();
  RunningTask managed("ros2::ManagedNode", "talker_node");
  managed.run(subscribing());
  ASSERT_EQ(managed.task().state(), TaskState::Running);
  ASSERT_TRUE(
      eventually([&] { return peer->publishers() == 1 && count(managed, "subscribes", "matched") == 1; }));
  Writer<> writer(input(managed));
  writer.write("one");
  EXPECT_EQ(heard(1), Texts{"one"});
  node.hide(true);
  ASSERT_TRUE(eventually([&] { return managed.task().state() == TaskState::RunTimeError; }));
  writer.write("two");
  EXPECT_EQ(heard(1), Texts{"two"});
  node.hide(false);
  EXPECT_TRUE(eventually([&] { return managed.task().state() == TaskState::Running; }));
}

/// Fast DDS allocates for each message and reader. In this thread, since allocations are counted by thread.
TEST_P(NodePorts, SendWithoutAllocatingMoreThanFastDds) {
  listen();
  segue::VirtualClock clock;
  const auto executor = std::make_shared<segue::task::ManualExecutor>(clock);
  auto made =
      segue::task::Task::create("talker_node", segue::task::find_component("ros2::Node")->create().value(),
                                segue::Activity(), executor);
  ASSERT_TRUE(made);
  segue::task::Task& node = **made;
  ASSERT_EQ(error_of(node.set_properties(subscribing(), soon())), "");
  ASSERT_EQ(error_of(node.configure(soon())), "");
  ASSERT_EQ(error_of(node.start(soon())), "");
  const auto participant = Participant::join({own_domain(), Range::Localhost}).value();
  Quality quality;
  quality.depth = 100;
  const auto bare =
      participant->make_writer({"rt/chatter", "std_msgs::msg::dds_::String_"}, quality, "", nullptr).value();
  ASSERT_TRUE(eventually([&] { return peer->publishers() == 2; }));
  Writer<> writer(*node.component().find_input("words"));
  const Bytes message = text_message("a text of some length");
  std::size_t least = 1000;  // a look at the node, once a second, allocates as well
  std::size_t least_bare = 1000;
  for (int i = 0; i < 100; ++i) {
    BytesSource source(message);
    segue::testing::allocations = 0;
    bare->write(static_cast<MessageSource*>(&source));
    least_bare = std::min(least_bare, segue::testing::allocations);
    writer.write("a text of some length");
    segue::testing::allocations = 0;
    executor->run_ready();
    least = std::min(least, segue::testing::allocations);
  }
  EXPECT_EQ(least, least_bare);
  EXPECT_GE(heard(1).size(), 1U);
}

INSTANTIATE_TEST_SUITE_P(, NodePorts, ::testing::Values(Middleware::FastDds, Middleware::Cyclone),
                         middleware_name);

/// The error of a Node with this property.
std::string refused_as(const char* property, Value value) {
  RunningTask task("ros2::Node", "talker_node");
  auto values = publishing("1s");
  values["name"] = "/robot/talker";
  values[property] = std::move(value);
  return error_of(task.configure(values));
}

Value one_port(const std::string& name, Value settings) {
  return Value::map({{name, std::move(settings)}});
}

TEST(NodePortProperties, AreRefusedWithAReason) {
  EXPECT_THAT(refused_as("publishes", 3), HasSubstr("publishes: expected a map from ports to topics"));
  EXPECT_THAT(refused_as("publishes", one_port("scan", 3)),
              HasSubstr("publishes.scan: expected an interface"));
  EXPECT_THAT(refused_as("publishes", one_port("scan", Value::map({{"topic", "/scan"}}))),
              HasSubstr("publishes.scan: expected an interface"));
  EXPECT_THAT(refused_as("publishes", one_port("scan", Value::map({{"type", kText}, {"reliabilty", "x"}}))),
              HasSubstr("reliabilty"));
  EXPECT_THAT(refused_as("publishes", one_port("a b", kText)),
              HasSubstr("'a b' is not a valid name of a port"));
  EXPECT_THAT(refused_as("publishes", one_port("state", kText)),
              HasSubstr("every task has a port of that name"));
  EXPECT_THAT(refused_as("subscribes", one_port("words", kText)),
              HasSubstr("the name is in subscribes, too"));
  EXPECT_THAT(refused_as("subscribes", one_port("in", "std_msgs/msg/Strin")), HasSubstr("subscribes.in: "));
  EXPECT_THAT(refused_as("publishes", one_port("out", Value::map({{"type", kText}, {"topic", "/a b"}}))),
              HasSubstr("publishes.out: '/a b' is not a valid name of a topic"));
  EXPECT_THAT(
      refused_as("publishes", one_port("out", Value::map({{"type", kText}, {"reliability", "often"}}))),
      HasSubstr("publishes.out: "));
  EXPECT_THAT(refused_as("ready", Value::list({"word"})), HasSubstr("publishes has no 'word'"));
  EXPECT_THAT(refused_as("ready", Value::list({"nothing"})),
              HasSubstr("publishes has no 'nothing'; it has words"));
}

}  // namespace
}  // namespace ros2::testing

// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/dds_names.hpp>
#include <segue/ros2/node_graph.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <cstring>

namespace segue::ros2 {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Gid gid(std::uint8_t number) {
  Gid made{};
  made.fill(number);
  return made;
}

Endpoint publisher_of_strings(std::uint8_t number) {
  return {gid(number), true, "rt/chatter", "std_msgs::msg::dds_::String_", "RIHS01_a", {}};
}

Endpoint subscription_to_strings() {
  Endpoint own = publisher_of_strings(99);
  own.publishes = false;
  return own;
}

/// The texts of mismatches.
std::vector<std::string> texts(const NodeGraph& graph, const Endpoint& own) {
  std::vector<std::string> all;
  for (const Mismatch& one : graph.mismatches_of(own))
    all.push_back(one.text);
  return all;
}

TEST(Quality, WhatDoesNotMatchIsSaidByWhoOffersAndWhoRequests) {
  Quality offered;
  Quality requested;
  EXPECT_THAT(mismatches(offered, requested), IsEmpty());
  offered.reliability = Reliability::BestEffort;
  requested.durability = Durability::TransientLocal;
  requested.deadline = std::chrono::milliseconds(100);
  offered.deadline = std::chrono::seconds(1);
  requested.liveliness = Liveliness::ManualByTopic;
  requested.lease = std::chrono::seconds(2);
  EXPECT_THAT(mismatches(offered, requested),
              ElementsAre("reliability: best_effort is offered, reliable is requested",
                          "durability: volatile is offered, transient_local is requested",
                          "deadline: 1s is offered, 100ms is requested",
                          "liveliness: automatic is offered, manual_by_topic is requested",
                          "lease of liveliness: infinite is offered, 2s is requested"));
  EXPECT_THAT(mismatches(requested, offered), IsEmpty()) << "whoever offers more than is requested matches";
}

TEST(Quality, WordsAreThoseOfRos2) {
  EXPECT_EQ(parse_reliability("best_effort"), Reliability::BestEffort);
  EXPECT_EQ(parse_durability("transient_local"), Durability::TransientLocal);
  EXPECT_EQ(parse_liveliness("manual_by_topic"), Liveliness::ManualByTopic);
  EXPECT_EQ(parse_reliability("often").error().message,
            "reliability 'often' is not known: expected reliable or best_effort");
}

TEST(DdsNames, AreThoseOfRos2BothWays) {
  EXPECT_EQ(dds_topic_name("/a/b_1"), "rt/a/b_1");
  EXPECT_EQ(dds_topic_name("chatter"), "rt/chatter");
  EXPECT_EQ(topic_of_dds_name("rt/a/b_1"), "/a/b_1");
  EXPECT_EQ(topic_of_dds_name("ros_discovery_info"), "ros_discovery_info");
  for (const char* wrong : {"", "/", "/a/", "a//b", "/1a", "a b", "~/a"})
    EXPECT_FALSE(dds_topic_name(wrong)) << wrong;
  EXPECT_EQ(dds_type_name("std_srvs/srv/SetBool_Request"), "std_srvs::srv::dds_::SetBool_Request_");
  EXPECT_EQ(interface_of_dds_type("std_srvs::srv::dds_::SetBool_Request_"), "std_srvs/srv/SetBool_Request");
  EXPECT_EQ(interface_of_dds_type("HelloWorld"), "HelloWorld");
}

TEST(ParticipantEntities, AreReadAsWritten) {
  for (const bool before_iron : {false, true}) {
    const ParticipantEntities two{
        gid(7), {{"/", "talker", {}, {gid(1), gid(2)}}, {"/robot", "arm", {gid(3)}, {gid(4)}}}, before_iron};
    EXPECT_EQ(decode_participant_entities(encode(two)), two);
    const ParticipantEntities none{gid(7), {}, before_iron};
    EXPECT_EQ(decode_participant_entities(encode(none)), none);
  }
}

/// Appends bytes at their alignment of CDR.
class Cdr {
 public:
  void number(std::uint32_t value) {
    bytes.resize(4 + (bytes.size() - 4 + 3) / 4 * 4);
    append(&value, sizeof value);
  }
  void text(const std::string& value) {
    number(static_cast<std::uint32_t>(value.size() + 1));
    append(value.c_str(), value.size() + 1);
  }
  void identifier(std::uint8_t value) {
    const std::array<std::uint8_t, 8> rest{};
    append(gid(value).data(), 16);
    append(rest.data(), rest.size());
  }
  std::vector<std::byte> bytes{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};

 private:
  void append(const void* data, std::size_t size) {
    const auto* begin = static_cast<const std::byte*>(data);
    bytes.insert(bytes.end(), begin, begin + size);
  }
};

TEST(ParticipantEntities, OfHumbleHaveLongerIdentifiers) {
  Cdr humble;
  humble.identifier(7);
  humble.number(1);
  humble.text("/");
  humble.text("talker");
  humble.number(0);
  humble.number(2);
  humble.identifier(1);
  humble.identifier(2);
  const ParticipantEntities expected{gid(7), {{"/", "talker", {}, {gid(1), gid(2)}}}, true};
  EXPECT_EQ(decode_participant_entities(humble.bytes), expected);
  EXPECT_EQ(encode(expected), humble.bytes);
}

TEST(ParticipantEntities, OfHumbleWithoutNodesAreToldApart) {
  Cdr humble;
  humble.identifier(7);
  humble.number(0);
  const ParticipantEntities expected{gid(7), {}, true};
  EXPECT_EQ(decode_participant_entities(humble.bytes), expected);
}

TEST(ParticipantEntities, HostileBytesAreRefused) {
  auto whole = encode({gid(7), {{"/", "talker", {gid(3)}, {gid(1), gid(2)}}}});
  for (std::size_t size = 0; size + 4 < whole.size(); ++size)
    EXPECT_EQ(decode_participant_entities(std::span(whole).first(size)), std::nullopt) << size;
  std::fill(whole.begin() + 20, whole.begin() + 24, std::byte{0xff});
  EXPECT_EQ(decode_participant_entities(whole), std::nullopt);
}

/// Why a participant may not have that node; empty: it may.
std::string refusal(const NodeEntities& node) {
  const auto checked = check(ParticipantEntities{gid(1), {{"/", "talker", {}, {gid(1)}}, node}}, gid(1));
  return checked ? "" : checked.error().message;
}

TEST(ParticipantEntities, MaySayWhatAParticipantItselfHas) {
  EXPECT_EQ(refusal({"/", "_hidden_1", {gid(1)}, {gid(1)}}), "");
  EXPECT_EQ(refusal({"/robot/front", "lidar", {}, {}}), "");
  EXPECT_EQ(check(ParticipantEntities{gid(1), {}}, gid(2)).error().message,
            "it speaks for another participant");
  EXPECT_EQ(refusal({"/", "thief", {}, {gid(1), gid(2)}}),
            "it says that node /thief has endpoints of others");
  EXPECT_EQ(refusal({"/", "thief", {gid(2)}, {}}), "it says that node /thief has endpoints of others");
  const ParticipantEntities many{gid(1), std::vector<NodeEntities>(kMostNodes + 1, {"/", "one", {}, {}})};
  EXPECT_EQ(check(many, gid(1)).error().message, "it has 1001 nodes, more than the 1000 that are taken");
}

TEST(ParticipantEntities, HaveNamesOfRos2) {
  const std::string kNoName = "it has a node whose name is not a valid one";
  for (const std::string& name :
       {std::string(), std::string("a b"), std::string("\033[2J"), std::string("1st"), std::string(256, 'a')})
    EXPECT_EQ(refusal({"/", name, {}, {}}), kNoName) << name;
  for (const char* name_space : {"", "robot", "/robot/", "//", "/a\nb"})
    EXPECT_EQ(refusal({name_space, "lidar", {}, {}}), kNoName) << name_space;
}

TEST(Endpoint, HasNamesThatCanBeShown) {
  Endpoint endpoint = publisher_of_strings(1);
  EXPECT_TRUE(check(endpoint));
  for (std::string* name : {&endpoint.topic, &endpoint.type}) {
    const std::string good = *name;
    for (const std::string& wrong :
         {std::string(), std::string("a\033[31m"), std::string("\xff"), std::string(257, 'a')}) {
      *name = wrong;
      EXPECT_FALSE(check(endpoint)) << wrong;
    }
    *name = good;
  }
  EXPECT_EQ(type_hash_in("typehash=RIHS01_0a;"), "RIHS01_0a");
  EXPECT_EQ(type_hash_in("sertypehash=RIHS01_0b;typehash=RIHS01_0a;"), "RIHS01_0a");
  EXPECT_EQ(service_hash_in("typehash=RIHS01_0a;sertypehash=RIHS01_0b;"), "RIHS01_0b");
  EXPECT_EQ(type_hash_in("typehash=\033[2J;"), "");
  EXPECT_EQ(type_hash_in("typehash=" + std::string(101, 'a')), "");
}

TEST(NodeGraph, KnowsTheEndpointsOfATopic) {
  NodeGraph graph;
  const Endpoint own = subscription_to_strings();
  graph.set(publisher_of_strings(1));
  Endpoint other = publisher_of_strings(2);
  other.topic = "rt/other";
  graph.set(other);
  EXPECT_EQ(graph.endpoints("rt/chatter", true).size(), 1);
  EXPECT_THAT(graph.endpoints("rt/chatter", false), IsEmpty());
  other.topic = "rt/chatter";
  graph.set(other);
  EXPECT_EQ(graph.endpoints("rt/chatter", true).size(), 2);
  EXPECT_THAT(graph.endpoints("rt/other", true), IsEmpty());
  graph.remove(gid(2));
  graph.remove(gid(2));
  EXPECT_EQ(graph.endpoints("rt/chatter", true).size(), 1);
}

TEST(NodeGraph, SaysWhichNodeDoesNotMatchAndWhy) {
  NodeGraph graph;
  Endpoint talker = publisher_of_strings(1);
  talker.quality.reliability = Reliability::BestEffort;
  graph.set(talker);
  graph.set(publisher_of_strings(2));
  const Endpoint own = subscription_to_strings();
  EXPECT_THAT(texts(graph, own),
              ElementsAre("a program that is not a node publishes /chatter, but reliability: best_effort is "
                          "offered, reliable is requested"));
  graph.set(ParticipantEntities{gid(50), {{"/", "talker", {}, {gid(1)}}}});
  EXPECT_THAT(texts(graph, own), ElementsAre(HasSubstr("node /talker publishes /chatter, but")));
  graph.remove(gid(1));
  EXPECT_THAT(texts(graph, own), IsEmpty());
}

TEST(NodeGraph, TellsWhoseNameIsStillToCome) {
  NodeGraph graph;
  Endpoint talker = publisher_of_strings(1);
  talker.quality.reliability = Reliability::BestEffort;
  graph.set(talker);
  const Endpoint own = subscription_to_strings();
  EXPECT_TRUE(graph.mismatches_of(own).front().is_named) << "its participant is not one of ROS 2";
  Gid participant = gid(1);
  participant[12] = participant[13] = 0;
  participant[14] = 1;
  participant[15] = 0xc1;
  graph.add_participant(participant);
  EXPECT_FALSE(graph.mismatches_of(own).front().is_named);
  graph.set(ParticipantEntities{participant, {{"/", "talker", {}, {gid(1)}}}});
  EXPECT_TRUE(graph.mismatches_of(own).front().is_named);
  graph.remove_participant(participant);
  EXPECT_TRUE(graph.mismatches_of(own).front().is_named);
}

TEST(NodeGraph, SaysThatATypeIsAnotherOne) {
  NodeGraph graph;
  Endpoint other = publisher_of_strings(1);
  other.type = "std_msgs::msg::dds_::Int32_";
  graph.set(other);
  const Endpoint own = subscription_to_strings();
  EXPECT_THAT(texts(graph, own),
              ElementsAre(HasSubstr("but its type is std_msgs/msg/Int32, here it is std_msgs/msg/String")));
  other = publisher_of_strings(1);
  other.type_hash = type_hash_in("a=b;typehash=RIHS01_b;");
  graph.set(other);
  EXPECT_THAT(texts(graph, own), ElementsAre(HasSubstr("its definition of std_msgs/msg/String is another "
                                                       "one (RIHS01_b, here RIHS01_a)")));
  other.type_hash = type_hash_in("");
  graph.set(other);
  EXPECT_THAT(texts(graph, own), IsEmpty()) << "nodes before Iron have no hashes";
}

TEST(NodeGraph, ForgetsNodesWithTheirParticipant) {
  NodeGraph graph;
  graph.set(ParticipantEntities{gid(50), {{"/", "talker", {}, {gid(1)}}, {"/a", "b", {gid(2)}, {}}}});
  EXPECT_TRUE(graph.has_node("/talker", gid(51)));
  EXPECT_TRUE(graph.has_node("/a/b", gid(51)));
  EXPECT_FALSE(graph.has_node("/a/b", gid(50))) << "an own one";
  EXPECT_EQ(graph.node_of(gid(2)), "/a/b");
  graph.set(ParticipantEntities{gid(50), {{"/", "listener", {gid(2)}, {}}}});
  EXPECT_EQ(graph.node_of(gid(1)), "");
  EXPECT_EQ(graph.node_of(gid(2)), "/listener");
  graph.remove_participant(gid(50));
  EXPECT_FALSE(graph.has_node("/listener", gid(51)));
  EXPECT_EQ(graph.node_of(gid(2)), "");
}

TEST(NodeGraph, KnowsWhichParticipantsWereFoundAfterOthers) {
  NodeGraph graph;
  const auto finds = [&](std::uint8_t participant) {
    graph.add_participant(gid(participant));
    graph.set(ParticipantEntities{gid(participant), {{"/", "talker", {}, {}}}});
  };
  finds(1);
  finds(2);
  finds(1);
  const std::uint64_t before = graph.seen_so_far();
  EXPECT_EQ(before, 2U);
  EXPECT_TRUE(graph.has_node("/talker", gid(51)));
  EXPECT_FALSE(graph.has_node("/talker", gid(51), before)) << "those were there";
  finds(3);
  EXPECT_TRUE(graph.has_node("/talker", gid(51), before));
  graph.remove_participant(gid(3));
  EXPECT_FALSE(graph.has_node("/talker", gid(51), before));
  graph.remove_participant(gid(1));
  finds(1);
  EXPECT_TRUE(graph.has_node("/talker", gid(51), before)) << "it has come back";
}

}  // namespace
}  // namespace segue::ros2

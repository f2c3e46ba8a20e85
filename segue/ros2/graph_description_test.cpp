// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/graph_description.hpp>

#include <gmock/gmock.h>

namespace segue::ros2 {
namespace {

using type::Value;

Gid gid_number(std::uint8_t number) {
  Gid made{};
  made.fill(number);
  return made;
}

Endpoint endpoint(std::uint8_t number, bool publishes, const std::string& topic, const std::string& type) {
  return {gid_number(number), publishes, topic, type, "", {}};
}

/// The server of a service, as the two endpoints of numbers `first` and `first` + 1.
void add_server(NodeGraph& graph, std::uint8_t first, const std::string& service, const std::string& type) {
  graph.set(endpoint(first, false, "rq" + service + "Request", type + "_Request_"));
  graph.set(
      endpoint(static_cast<std::uint8_t>(first + 1), true, "rr" + service + "Reply", type + "_Response_"));
}

Value node_named(const NodeGraph& graph, const std::string& name) {
  for (const Value& node : describe_nodes(graph.snapshot())) {
    if (node.find("name")->as_string() == name) return node;
  }
  return Value();
}

TEST(GraphDescription, HasTheTopicsOfEachNodeWithTheirQuality) {
  NodeGraph graph;
  Endpoint scan = endpoint(1, true, "rt/scan", "sensor_msgs::msg::dds_::LaserScan_");
  scan.quality.reliability = Reliability::BestEffort;
  scan.quality.deadline = std::chrono::milliseconds(100);
  scan.type_hash = "RIHS01_a";
  graph.set(scan);
  graph.set(ParticipantEntities{gid_number(9),
                                {{"/", "lidar", {}, {gid_number(1), gid_number(2)}}, {"/robot", "idle"}}});
  const Value lidar = node_named(graph, "/lidar");
  EXPECT_EQ(*lidar.find("publishers"),
            Value::list({Value::map({{"topic", "/scan"},
                                     {"type", "sensor_msgs/msg/LaserScan"},
                                     {"hash", "RIHS01_a"},
                                     {"quality", Value::map({{"reliability", "best_effort"},
                                                             {"durability", "volatile"},
                                                             {"deadline", "100ms"}})}})}));
  EXPECT_EQ(*lidar.find("unseen_endpoints"), Value(1)) << "one that it names has not been found";
  EXPECT_EQ(*lidar.find("managed"), Value(false));
  EXPECT_EQ(*node_named(graph, "/robot/idle").find("publishers"), Value(Value::List()));
}

TEST(GraphDescription, HasServicesAndActionsByWhoServesAndWhoUsesThem) {
  NodeGraph graph;
  add_server(graph, 1, "/nav/change_state", "lifecycle_msgs::srv::dds_::ChangeState");
  add_server(graph, 3, "/nav/get_state", "lifecycle_msgs::srv::dds_::GetState");
  add_server(graph, 5, "/navigate/_action/send_goal", "nav::action::dds_::Navigate_SendGoal");
  add_server(graph, 7, "/navigate/_action/cancel_goal", "action_msgs::srv::dds_::CancelGoal");
  graph.set(
      endpoint(20, true, "rt/navigate/_action/feedback", "nav::action::dds_::Navigate_FeedbackMessage_"));
  graph.set(endpoint(21, true, "rq/navigate/_action/send_goalRequest",
                     "nav::action::dds_::Navigate_SendGoal_Request_"));
  NodeEntities server{"/", "nav", {}, {gid_number(20)}};
  for (std::uint8_t i = 1; i < 9; i += 2)
    server.subscriptions.push_back(gid_number(i));
  graph.set(ParticipantEntities{gid_number(99), {server, {"/", "user", {}, {gid_number(21)}}}});
  const Value nav = node_named(graph, "/nav");
  EXPECT_EQ(*nav.find("managed"), Value(true));
  EXPECT_EQ(nav.find("services")->as_list().size(), 2U) << "those of actions are parts of these";
  EXPECT_EQ(*nav.find("actions"),
            Value::list({Value::map({{"name", "/navigate"}, {"type", "nav/action/Navigate"}})}));
  EXPECT_EQ(*nav.find("publishers"), Value(Value::List()));
  EXPECT_EQ(*nav.find("copies"), Value(1));
  EXPECT_EQ(*node_named(graph, "/user").find("action_clients"), *nav.find("actions"));
  EXPECT_EQ(describe_topics(graph.snapshot()).size(), 0U);
}

TEST(GraphDescription, HasTheHashesOfServicesAndActions) {
  NodeGraph graph;
  const auto add = [&](std::uint8_t number, bool publishes, const std::string& topic, const std::string& type,
                       const std::string& hash, const std::string& service_hash) {
    Endpoint made = endpoint(number, publishes, topic, type);
    made.type_hash = hash;
    made.service_hash = service_hash;
    graph.set(made);
  };
  add(1, false, "rq/askRequest", "a::srv::dds_::Ask_Request_", "q", "s");
  add(2, true, "rr/askReply", "a::srv::dds_::Ask_Response_", "r", "s");
  add(3, false, "rq/dock/_action/send_goalRequest", "a::action::dds_::Dock_SendGoal_Request_", "", "g");
  add(4, true, "rr/dock/_action/get_resultReply", "a::action::dds_::Dock_GetResult_Response_", "", "e");
  add(5, true, "rt/dock/_action/feedback", "a::action::dds_::Dock_FeedbackMessage_", "f", "");
  add(6, true, "rr/dock/_action/cancel_goalReply", "action_msgs::srv::dds_::CancelGoal_Response_", "", "c");
  const std::vector<Gid> all = {gid_number(1), gid_number(2), gid_number(3),
                                gid_number(4), gid_number(5), gid_number(6)};
  graph.set(ParticipantEntities{gid_number(99), {{"/", "nav", all, {}}}});
  const Value nav = node_named(graph, "/nav");
  EXPECT_EQ(
      *nav.find("services"),
      Value::list({Value::map(
          {{"name", "/ask"},
           {"type", "a/srv/Ask"},
           {"hashes",
            Value::map({{"a/srv/Ask", "s"}, {"a/srv/Ask_Request", "q"}, {"a/srv/Ask_Response", "r"}})}})}));
  EXPECT_EQ(*nav.find("actions"),
            Value::list({Value::map({{"name", "/dock"},
                                     {"type", "a/action/Dock"},
                                     {"hashes", Value::map({{"a/action/Dock_FeedbackMessage", "f"},
                                                            {"a/action/Dock_GetResult", "e"},
                                                            {"a/action/Dock_SendGoal", "g"}})}})}));
  EXPECT_EQ(*nav.find("clients"), Value(Value::List()));
}

TEST(GraphDescription, SaysThatTwoNodesHaveOneName) {
  NodeGraph graph;
  add_server(graph, 1, "/nav/get_parameters", "rcl_interfaces::srv::dds_::GetParameters");
  add_server(graph, 3, "/nav/get_parameters", "rcl_interfaces::srv::dds_::GetParameters");
  graph.set(ParticipantEntities{gid_number(98), {{"/", "nav", {gid_number(1)}, {gid_number(2)}}}});
  graph.set(ParticipantEntities{gid_number(99), {{"/", "nav", {gid_number(3)}, {gid_number(4)}}}});
  EXPECT_EQ(*node_named(graph, "/nav").find("copies"), Value(2));
}

TEST(GraphDescription, HasTopicsWithTheNodesOnBothSides) {
  NodeGraph graph;
  graph.set(endpoint(1, true, "rt/chatter", "std_msgs::msg::dds_::String_"));
  graph.set(endpoint(2, false, "rt/chatter", "std_msgs::msg::dds_::Int32_"));
  graph.set(ParticipantEntities{gid_number(9), {{"/", "talker", {}, {gid_number(1)}}}});
  EXPECT_EQ(
      Value(describe_topics(graph.snapshot())),
      Value::list({Value::map(
          {{"topic", "/chatter"},
           {"types", Value::list({"std_msgs/msg/Int32", "std_msgs/msg/String"})},
           {"publishers", Value::list({"/talker"})},
           {"subscriptions", Value::list({""})},
           {"mismatches",
            Value::list({Value::map({{"publisher", "/talker"},
                                     {"subscription", ""},
                                     {"reasons", Value::list({"type: std_msgs/msg/String is offered, "
                                                              "std_msgs/msg/Int32 is requested"})}})})}})}))
      << "the subscription is not a node's";
}

TEST(GraphDescription, SaysWhyNoSamplesTravelBetweenTwoNodes) {
  NodeGraph graph;
  Endpoint scan = endpoint(1, true, "rt/scan", "sensor_msgs::msg::dds_::LaserScan_");
  scan.quality.reliability = Reliability::BestEffort;
  graph.set(scan);
  scan.publishes = false;
  for (std::uint8_t number = 2; number < 4; ++number) {
    scan.gid = gid_number(number);
    graph.set(scan);
    scan.quality.reliability = Reliability::Reliable;
  }
  graph.set(ParticipantEntities{gid_number(9),
                                {{"/", "lidar", {gid_number(1)}, {}},
                                 {"/", "map", {}, {gid_number(2)}},
                                 {"/", "slam", {}, {gid_number(3)}}}});
  EXPECT_EQ(*describe_topics(graph.snapshot()).at(0).find("mismatches"),
            Value::list({Value::map({{"publisher", "/lidar"},
                                     {"subscription", "/slam"},
                                     {"reasons", Value::list({"reliability: best_effort is offered, reliable "
                                                              "is requested"})}})}));
  for (std::uint8_t number = 10; number < 200; ++number) {
    scan.gid = gid_number(number);
    graph.set(scan);
  }
  EXPECT_EQ(describe_topics(graph.snapshot()).at(0).find("mismatches")->as_list().size(),
            NodeGraph::kMostMismatches);
}

}  // namespace
}  // namespace segue::ros2

// SPDX-License-Identifier: Apache-2.0
#include "ros2_robot.hpp"

#include <segue/type/yaml.hpp>

#include <gmock/gmock.h>

namespace segue::cli {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using type::Value;

Value node(const std::string& name, bool managed = false) {
  return Value::map({{"name", name},
                     {"managed", managed},
                     {"parameters", Value(Value::List())},
                     {"problems", Value(Value::List())}});
}

Value parameter_named(const std::string& name, const std::string& kind, Value value, bool read_only = false) {
  return Value::map({{"name", name}, {"kind", kind}, {"value", std::move(value)}, {"read_only", read_only}});
}

Value process_with(const std::string& program, int nodes = 1) {
  return Value::map({{"pid", 7},
                     {"nodes", nodes},
                     {"command", Value::list({program})},
                     {"installation", "/opt/ros/jazzy"},
                     {"package", "demo"},
                     {"executable", "talker"},
                     {"remappings", Value::list({"/scan:=/front/scan"})},
                     {"arguments", Value(Value::List())}});
}

Ros2Robot robot_of(Value::List nodes, bool starts = true) {
  const Value topics = Value::list({Value::map({{"topic", "/scan"},
                                                {"types", Value::list({"sensor_msgs/msg/LaserScan"})},
                                                {"publishers", Value::list({"/lidar"})},
                                                {"subscriptions", Value::list({"/slam", ""})}}),
                                    Value::map({{"topic", "/rosout"},
                                                {"types", Value::list({"rcl_interfaces/msg/Log"})},
                                                {"publishers", Value::list({"/lidar"})},
                                                {"subscriptions", Value(Value::List())}})});
  return ros2_robot(Value::map({{"nodes", Value(std::move(nodes))}, {"topics", topics}}), "rover", starts);
}

/// The controller's file as a value.
Value network_of(const Ros2Robot& robot) {
  const auto read = type::parse_yaml(robot.files.at(1).text);
  EXPECT_TRUE(read) << robot.files.at(1).text << to_string(read.error());
  return read.value_or(Value());
}

TEST(Ros2Robot, HasATaskForEachNodeWithTheParametersThatCanBeSet) {
  Value lidar = node("/front/lidar", true);
  lidar.as_map().set(
      "parameters",
      Value::list({parameter_named("rate", "integer", 10), parameter_named("filter.gain", "double", 2.0),
                   parameter_named("names", "string array", Value(Value::List())),
                   parameter_named("serial", "string", "A-17", true),
                   parameter_named("empty", "double array", Value(Value::List())),
                   parameter_named("unset", "not set", Value()),
                   parameter_named("use_sim_time", "boolean", false),
                   parameter_named("qos_overrides./scan.depth", "integer", 5)}));
  const Ros2Robot robot = robot_of({lidar, node("/talker")});
  const Value network = network_of(robot);
  const Value& task = *network.find("tasks")->find("front_lidar");
  EXPECT_EQ(*task.find("component"), Value("ros2::ManagedNode"));
  EXPECT_EQ(
      *task.find("properties"),
      Value::map({{"name", "/front/lidar"},
                  {"parameters",
                   Value::map({{"rate", 10}, {"filter.gain", 2.0}, {"names", Value(Value::List())}})}}));
  EXPECT_EQ(task.find("properties")->find("parameters")->find("filter.gain")->kind(), Value::Kind::Float);
  EXPECT_THAT(robot.files[1].text, HasSubstr("# parameters that cannot be set: serial and empty\n"));
  EXPECT_EQ(*network.find("tasks")->find("talker")->find("component"), Value("ros2::Node"));
  EXPECT_EQ(*network.find("deployments"),
            Value::map({{"ros2", Value::map({{"tasks", Value::list({"front_lidar", "talker"})}})}}));
  EXPECT_THAT(robot.nodes, ElementsAre("/front/lidar", "/talker"));
}

TEST(Ros2Robot, StartsProgramsThatHaveOneNode) {
  Value alone = node("/talker");
  alone.as_map().set("process", process_with("/opt/ros/jazzy/lib/demo/talker"));
  alone.as_map().set("parameters", Value::list({parameter_named("serial", "string", "A-17", true)}));
  Value inside = node("/inside");
  inside.as_map().set("process", process_with("/opt/ros/jazzy/lib/rclcpp_components/component_container", 2));
  const Ros2Robot robot = robot_of({alone, inside});
  EXPECT_EQ(*network_of(robot).find("tasks")->find("talker")->find("properties"),
            Value::map({{"name", "/talker"},
                        {"parameters", Value::map({{"serial", "A-17"}})},
                        {"process", Value::map({{"package", "demo"},
                                                {"executable", "talker"},
                                                {"remappings", Value::list({"/scan:=/front/scan"})}})}}));
  EXPECT_THAT(robot.started, ElementsAre("/talker"));
  EXPECT_THAT(robot.files[1].text, HasSubstr("# of installation /opt/ros/jazzy\n"));
  EXPECT_THAT(robot.files[1].text, HasSubstr("# in process 7 with 1 other nodes\n"));
  EXPECT_THAT(robot_of({alone, inside}, false).files[1].text, Not(HasSubstr("process:")));
}

/// A component of container /nav, whose process has both.
Value component(const std::string& name, Value::List plugins, const std::string& evidence,
                Value::List unknown = {}) {
  Value made = node(name);
  made.as_map().set("process", process_with("/opt/ros/jazzy/lib/demo/talker", 2));
  made.as_map().set("container", Value::map({{"name", "/nav"},
                                             {"id", 1},
                                             {"evidence", evidence},
                                             {"plugins", Value(std::move(plugins))},
                                             {"components", 1},
                                             {"unknown", Value(std::move(unknown))}}));
  return made;
}

Value container_with(const Value& its_component) {
  Value made = node("/nav");
  made.as_map().set("process", *its_component.find("process"));
  const Value& entry = *its_component.find("container");
  made.as_map().set("components", Value::list({Value::map({{"id", 1},
                                                           {"name", *its_component.find("name")},
                                                           {"evidence", *entry.find("evidence")},
                                                           {"plugins", *entry.find("plugins")}})}));
  return made;
}

Value plugin_named(const std::string& name) {
  return Value::map({{"package", "nav2_planner"}, {"name", name}});
}

TEST(Ros2Robot, LoadsComponentsIntoTheirContainer) {
  Value planner = component("/planner", {plugin_named("nav::Planner")}, "name");
  planner.as_map().set("parameters", Value::list({parameter_named("serial", "string", "A-17", true)}));
  planner.as_map()["process"].as_map().set("arguments", Value::list({"--fast"}));
  const Ros2Robot robot = robot_of({container_with(planner), planner});
  EXPECT_EQ(
      *network_of(robot).find("tasks"),
      Value::map(
          {{"planner",
            Value::map({{"component", "ros2::Node"},
                        {"properties",
                         Value::map({{"name", "/planner"},
                                     {"parameters", Value::map({{"serial", "A-17"}})},
                                     {"process", Value::map({{"package", "nav2_planner"},
                                                             {"component", "nav::Planner"},
                                                             {"container", "/nav"},
                                                             {"container_program", "demo/talker"}})}})}})}}))
      << "the container is started with its component";
  EXPECT_THAT(robot.started, ElementsAre("/planner"));
  for (const char* note : {"# component of container /nav of installation /opt/ros/jazzy\n",
                           "# not known are remappings with which it was loaded: add them\n",
                           "# its plugin is known by its name or by elimination: check it\n",
                           "# the container was started with --fast, which Segue does not give it\n"})
    EXPECT_THAT(robot.files[1].text, HasSubstr(note));
}

TEST(Ros2Robot, TakesOverComponentsWhosePluginsAreNotKnown) {
  const Value planner =
      component("/planner", {plugin_named("nav::Planner"), plugin_named("nav::Map")}, "", {"/planner"});
  const Ros2Robot robot = robot_of({container_with(planner), planner});
  const Value tasks = *network_of(robot).find("tasks");
  EXPECT_EQ(*tasks.find("planner")->find("properties"), Value::map({{"name", "/planner"}}));
  EXPECT_NE(tasks.find("nav"), nullptr);
  EXPECT_THAT(robot.files[1].text,
              HasSubstr("# component of container /nav, which the robot cannot start: which plugins it loads "
                        "for /planner is not known\n"
                        "  # its plugin is not known; loaded are nav::Planner of package nav2_planner and "
                        "nav::Map of package nav2_planner\n"));
}

TEST(Ros2Robot, TakesOverContainersWhoseProgramHasOtherNodes) {
  Value planner = component("/planner", {plugin_named("nav::Planner")}, "only_one");
  planner.as_map().set("process", process_with("/opt/ros/jazzy/lib/demo/talker", 3));
  const Ros2Robot robot = robot_of({container_with(planner), planner});
  EXPECT_THAT(robot.started, ElementsAre());
  EXPECT_THAT(robot.nodes, ElementsAre("/nav", "/planner"));
  EXPECT_THAT(robot.files[1].text, HasSubstr("its program has other nodes, too\n"));
  EXPECT_THAT(robot_of({container_with(planner), planner}, false).files[1].text,
              Not(HasSubstr("container /nav")));
}

TEST(Ros2Robot, LeavesOutHiddenNodesAndThoseOfSegue) {
  Value own = node("/chatter");
  own.as_map().set("process", process_with("/usr/bin/segue-deployment"));
  EXPECT_THAT(robot_of({own, node("/robot/_ros2cli_daemon"), node("/talker")}).nodes, ElementsAre("/talker"));
}

TEST(Ros2Robot, HasIdsThatDiffer) {
  const Value network = network_of(robot_of({node("/a/b"), node("/a_b")}));
  EXPECT_EQ(*network.find("tasks")->find("a_b")->find("properties")->find("name"), Value("/a/b"));
  EXPECT_EQ(*network.find("tasks")->find("a_b_2")->find("properties")->find("name"), Value("/a_b"));
}

TEST(Ros2Robot, IsNotLedAstrayByNames) {
  Value strange = node("/a\n  b: {component: c}\x1b");
  strange.as_map().set("problems", Value::list({"one\ntasks: {}"}));
  const Value network = network_of(robot_of({strange}));
  ASSERT_EQ(network.find("tasks")->as_map().size(), 1U);
  EXPECT_EQ(*network.find("tasks")->as_map().begin()->second.find("properties")->find("name"),
            *strange.find("name"));
}

TEST(Ros2Robot, ListsTheTopicsBetweenNodes) {
  EXPECT_THAT(robot_of({node("/lidar")}).files[1].text,
              HasSubstr("#   /scan (sensor_msgs/msg/LaserScan): /lidar -> /slam, (not of a node)\nnetwork:"));
}

Value topic(const std::string& name, const std::string& type, Value quality) {
  return Value::map({{"topic", name}, {"type", type}, {"quality", std::move(quality)}});
}

TEST(Ros2Tasks, HaveTopicsAsPorts) {
  const Value usual = Value::map({{"reliability", "reliable"}, {"durability", "volatile"}});
  const Value sensor = Value::map({{"reliability", "best_effort"}, {"durability", "volatile"}});
  const Value late =
      Value::map({{"reliability", "best_effort"}, {"durability", "transient_local"}, {"deadline", "1s"}});
  Value lidar = node("/robot/lidar", true);
  lidar.as_map().set("publishers", Value::list({topic("/robot/scan", "sensor_msgs/msg/LaserScan", sensor),
                                                topic("/front/scan", "sensor_msgs/msg/LaserScan", usual),
                                                topic("/robot/ready", "std_msgs/msg/Bool", usual),
                                                topic("/rosout", "rcl_interfaces/msg/Log", usual)}));
  lidar.as_map().set("subscriptions", Value::list({topic("/ready", "std_msgs/msg/Bool", late),
                                                   topic("/parameter_events", "x", usual)}));
  const auto read = type::parse_yaml(ros2_tasks({lidar}));
  ASSERT_TRUE(read);
  EXPECT_EQ(*read->find("tasks")->find("robot_lidar")->find("properties"),
            Value::map({{"name", "/robot/lidar"},
                        {"publishes",
                         Value::map({{"scan", Value::map({{"type", "sensor_msgs/msg/LaserScan"},
                                                          {"reliability", "best_effort"}})},
                                     {"front_scan", Value::map({{"topic", "/front/scan"},
                                                                {"type", "sensor_msgs/msg/LaserScan"}})},
                                     {"ready", "std_msgs/msg/Bool"}})},
                        {"subscribes", Value::map({{"ready_2", Value::map({{"topic", "/ready"},
                                                                           {"type", "std_msgs/msg/Bool"},
                                                                           {"durability", "transient_local"},
                                                                           {"deadline", "1s"}})}})}}))
      << ros2_tasks({lidar});
}

}  // namespace
}  // namespace segue::cli

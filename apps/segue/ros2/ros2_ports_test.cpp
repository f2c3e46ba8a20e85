// SPDX-License-Identifier: Apache-2.0
#include "ros2_ports.hpp"

#include <segue/model/files.hpp>

#include <gmock/gmock.h>

#include <string>
#include <vector>

namespace segue::cli {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* kTasks = R"(
tasks:
  driver:
    component: ros2::Node
    properties:
      name: /robot/driver
      process: {package: p, executable: e, remappings: ['raw:=/raw']}
      publishes: {scan: sensor_msgs/msg/LaserScan, raw: sensor_msgs/msg/PointCloud2}
  slam:
    component: ros2::ManagedNode
    properties:
      name: /slam
      subscribes:
        near: {topic: /robot/scan, type: sensor_msgs/msg/LaserScan}
        far: {topic: /front/scan, type: sensor_msgs/msg/LaserScan}
        raw: sensor_msgs/msg/PointCloud2
  other: {component: ros2::Subscription, properties: {topic: robot/scan, type: sensor_msgs/msg/LaserScan}}
  out: {component: ros2::Publisher, properties: {topic: /robot/scan, type: sensor_msgs/msg/LaserScan}}
  far: {component: ros2::Publisher, properties: {topic: /robot/scan, type: sensor_msgs/msg/LaserScan, domain: 7}}
  sink: {component: demo::Sink}
)";

/// The problems of a network with these connections.
std::vector<std::string> problems(const std::string& connections, const std::string& tasks = kTasks) {
  Diagnostics diagnostics;
  const auto network = model::read_network(tasks + "connections:\n" + connections, "n.yaml", diagnostics);
  EXPECT_TRUE(network) << to_string(diagnostics);
  Diagnostics found;
  if (network) check_ros2_ports(*network, found);
  std::vector<std::string> texts;
  for (const Diagnostic& one : found.items())
    texts.push_back(one.code + ": " + one.message);
  return texts;
}

TEST(Ros2Ports, OfDifferentTopicsAreConnected) {
  EXPECT_THAT(problems("  - driver.scan -> slam.far\n  - driver.state -> sink.in\n  - driver.raw -> sink.in\n"
                       "  - other.out -> slam.far\n  - driver.scan -> far.in\n"),
              IsEmpty());
}

TEST(Ros2Ports, OfOneTopicAreNotConnected) {
  EXPECT_THAT(
      problems("  - driver.scan -> slam.near\n"),
      ElementsAre("same-topic: connection driver.scan -> slam.near: both are topic /robot/scan of ROS 2, on "
                  "which the samples travel already: no connection is needed, and with one they would come "
                  "twice"));
  EXPECT_THAT(problems("  - driver.raw -> slam.raw\n"), ElementsAre(HasSubstr("topic /raw")))
      << "it is remapped";
  EXPECT_THAT(problems("  - other.out -> out.in\n"), ElementsAre(HasSubstr("topic /robot/scan")));
}

TEST(Ros2Ports, OfTypesThatDifferAreNotConnected) {
  EXPECT_THAT(
      problems("  - driver.raw -> slam.far\n"),
      ElementsAre(
          "type-mismatch: connection driver.raw -> slam.far: /raw is sensor_msgs/msg/PointCloud2, but "
          "/front/scan is sensor_msgs/msg/LaserScan"));
}

TEST(Ros2Ports, AreThoseThatThePropertiesName) {
  EXPECT_THAT(
      problems("  - driver.scna -> sink.in\n"),
      ElementsAre(
          "unknown-port: connection driver.scna -> sink.in: property publishes of task 'driver' has no "
          "'scna', did you mean 'scan'?"));
  EXPECT_THAT(
      problems("  - driver.scan -> driver.raw\n"),
      ElementsAre("unknown-port: connection driver.scan -> driver.raw: property subscribes of task 'driver' "
                  "has no 'raw'"));
}

TEST(Ros2Ports, ThatAreNoTopicsAreReportedOnce) {
  EXPECT_THAT(
      problems(
          "  - node.a -> sink.in\n",
          "tasks:\n  node: {component: ros2::Node, properties: {name: /n, publishes: {a: {topic: /a}}}}\n"
          "  sink: {component: demo::Sink}\n"),
      ElementsAre(HasSubstr("wrong-topic: node.publishes.a: expected an interface")));
}

}  // namespace
}  // namespace segue::cli

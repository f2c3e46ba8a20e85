// SPDX-License-Identifier: Apache-2.0
//
// The updates of the components allocate nothing.
#include "../test_network.hpp"
#include "conversions.hpp"
#include "transform_test_support.hpp"

#include <segue/task/component.hpp>
#include <segue/task/realtime_log.hpp>
#include <support/allocation_trap.hpp>

#include <gtest/gtest.h>

namespace ros2_messages {
namespace {

using components_test::TestNetwork;
using segue::type::Value;

const std::string kLong(100, 'f');

struct Sources : segue::task::Component {
  segue::task::OutputPort<messages::LaserScan> scan{*this, "scan"};
  segue::task::OutputPort<messages::OccupancyGrid> map{*this, "map"};
  segue::task::OutputPort<messages::Path> path{*this, "path"};
  segue::task::OutputPort<messages::Twist2D> twist{*this, "twist"};
  segue::task::OutputPort<messages::Pose2D> pose{*this, "pose"};
  segue::task::OutputPort<messages::Image> image{*this, "image"};
  segue::task::OutputPort<messages::Odometry> odometry{*this, "odometry"};
  segue::task::OutputPort<messages::JointState> joints{*this, "joints"};
};

TEST(Ros2MessagesRealtime, UpdatesDoNotAllocate) {
  Sources sources;
  TestNetwork network;
  const auto chain = [&](const char* id, const char* back, Value properties,
                         segue::task::OutputPortBase& source) {
    network.add(id, std::string("to_ros2::") + id, properties);
    network.connect(source, network.input(id, "in"));
    if (back != nullptr) {
      network.add(back, std::string("from_ros2::") + id);
      network.connect(network.output(id, "out"), network.input(back, "in"));
      network.start(back);
    }
    network.start(id);
  };
  const Value framed = Value::map({{"frame", kLong}});
  chain("LaserScan", "scan", framed, sources.scan);
  chain("OccupancyGrid", "map", framed, sources.map);
  chain("Path", "path", Value::map({{"frame", "map"}}), sources.path);
  chain("Twist", "twist", Value::map({}), sources.twist);
  chain("Pose", "pose", framed, sources.pose);
  chain("Image", "image", framed, sources.image);
  chain("Odometry", "odometry", framed, sources.odometry);
  chain("Transform", nullptr, framed, sources.odometry);
  chain("JointState", "joints", Value::map({{"joints", Value::list({kLong, kLong + "2"})}}), sources.joints);
  for (std::size_t i = 0; i < 50; ++i) {
    sources.scan.write({1, 0, 0.1, 0, 10, std::vector<float>(i * 10, 1)});
    sources.map.write({1, 0.1, 0, 0, 100, static_cast<std::uint32_t>(i), std::vector<std::int8_t>(100 * i)});
    sources.path.write({{}, std::vector<messages::Pose2D>(i * 7)});
    sources.twist.write({1, 2});
    sources.pose.write({1, 2, 3});
    sources.image.write({1, 10, static_cast<std::uint32_t>(i), std::vector<std::uint8_t>(30 * i)});
    sources.odometry.write({});
    sources.joints.write({1, {0.1, 0.2}, {}, {}});
    segue::testing::trapped = true;
    network.run_ready();
    segue::testing::trapped = false;
  }
  EXPECT_EQ(segue::testing::caught, 0);
}

TEST(Ros2MessagesRealtime, UpdatesWithTransformsDoNotAllocate) {
  const segue::task::RealtimeLogDrain drain;
  struct Ends : segue::task::Component {
    segue::task::OutputPort<tf2_msgs::TFMessage> moving{*this, "moving"};
    segue::task::OutputPort<tf2_msgs::TFMessage> fixed{*this, "fixed"};
    segue::task::InputPort<messages::TimedPose> pose{*this, "pose"};
    segue::task::InputPort<tf2_msgs::TFMessage> told{*this, "told"};
  } ends;
  TestNetwork network;
  network.add("pose", "from_ros2::Transform", Value::map({{"frame", kLong}, {"child", kLong + "base"}}));
  network.add("all", "from_ros2::StaticTransforms");
  network.connect(ends.moving, network.input("pose", "in"));
  network.connect(ends.fixed, network.input("all", "in"));
  network.connect(network.output("all", "out"), network.input("pose", "static"));
  network.connect(network.output("all", "out"), ends.told);
  network.connect(network.output("pose", "out"), ends.pose);
  network.start("all");
  network.start("pose");
  const auto update = [&] {
    segue::testing::trapped = true;
    network.run_ready();
    segue::testing::trapped = false;
  };
  for (int i = 0; i < 50; ++i) {
    tf2_msgs::TFMessage moving;
    for (const std::string& child : {std::string("odom"), kLong + std::to_string(i)})
      moving.transforms.push_back(made_transform(kLong, child, i, i));
    moving.transforms.push_back(made_transform("", "broken", i, i));  // which is logged
    ends.moving.write(moving);
    ends.fixed.write({{made_transform("odom", kLong + "base", 0, 1),
                       made_transform("base", kLong + std::to_string(i), 0, 1)}});
    update();
    tf2_msgs::TFMessage told;
    ASSERT_EQ(ends.told.read(told), segue::task::ReadStatus::NewData);
    ASSERT_EQ(told.transforms.size(), static_cast<std::size_t>(i) + 2);
    messages::TimedPose pose;
    ASSERT_EQ(ends.pose.read(pose), segue::task::ReadStatus::NewData);
    ASSERT_EQ(pose.pose.position.x(), i + 1);
  }
  network.advance(std::chrono::seconds(5));
  update();
  EXPECT_EQ(network.task("pose").state_name(), "no_transform");
  EXPECT_EQ(segue::testing::caught, 0);
}

}  // namespace
}  // namespace ros2_messages

// SPDX-License-Identifier: Apache-2.0
//
// The updates of the components allocate nothing.
#include "../test_network.hpp"
#include "conversions.hpp"

#include <segue/task/component.hpp>
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
  chain("Path", nullptr, Value::map({{"frame", "map"}}), sources.path);
  chain("Odometry", "odometry", framed, sources.odometry);
  chain("Transform", nullptr, framed, sources.odometry);
  chain("JointState", "joints", Value::map({{"joints", Value::list({kLong, kLong + "2"})}}), sources.joints);
  for (std::size_t i = 0; i < 50; ++i) {
    sources.scan.write({1, 0, 0.1, 0, 10, std::vector<float>(i * 10, 1)});
    sources.map.write({1, 0.1, 0, 0, 100, static_cast<std::uint32_t>(i), std::vector<std::int8_t>(100 * i)});
    sources.path.write({{}, std::vector<messages::Pose2D>(i * 7)});
    sources.odometry.write({});
    sources.joints.write({1, {0.1, 0.2}, {}, {}});
    segue::testing::trapped = true;
    network.run_ready();
    segue::testing::trapped = false;
  }
  EXPECT_EQ(segue::testing::caught, 0);
}

}  // namespace
}  // namespace ros2_messages

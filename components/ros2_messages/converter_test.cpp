// SPDX-License-Identifier: Apache-2.0
#include "../test_network.hpp"
#include "conversions.hpp"

#include <segue/task/component.hpp>

#include <gmock/gmock.h>

namespace ros2_messages {
namespace {

using components_test::TestNetwork;
using segue::TaskState;
using segue::type::Value;

struct Ends : segue::task::Component {
  segue::task::OutputPort<messages::LaserScan> scan{*this, "scan"};
  segue::task::InputPort<sensor_msgs::LaserScan> sent{*this, "sent"};
};

TEST(Converters, LeaveOutSamplesThatAreTooLargeAndSaySo) {
  Ends ends;
  TestNetwork network;
  segue::task::Task& task =
      network.add("scan", "to_ros2::LaserScan", Value::map({{"most", 2}, {"frame", "front"}}));
  network.connect(ends.scan, network.input("scan", "in"));
  network.connect(network.output("scan", "out"), ends.sent);
  network.start("scan");
  const auto send = [&](std::size_t ranges) {
    ends.scan.write({1, 0, 0.1, 0, 10, std::vector<float>(ranges, 1)});
    network.run_ready();
  };
  sensor_msgs::LaserScan sent;
  send(2);
  EXPECT_EQ(ends.sent.read(sent), segue::task::ReadStatus::NewData);
  EXPECT_EQ(sent.header.frame_id, "front");
  send(3);
  EXPECT_EQ(ends.sent.read(sent), segue::task::ReadStatus::OldData);
  EXPECT_EQ(task.state(), TaskState::RunTimeError);
  EXPECT_EQ(task.state_name(), "refused");
  send(1);
  EXPECT_EQ(ends.sent.read(sent), segue::task::ReadStatus::NewData);
  EXPECT_EQ(task.state(), TaskState::Running);
}

}  // namespace
}  // namespace ros2_messages

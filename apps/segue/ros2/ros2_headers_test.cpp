// SPDX-License-Identifier: Apache-2.0
// The headers that `segue ros2 headers` has written for this test.
#include <segue/ros2/interface_library.hpp>
#include <segue/ros2/message_type.hpp>

#include <gtest/gtest.h>

#include <nav_msgs/msg/occupancy_grid.hpp>
#include <nav_msgs/msg/odometry.hpp>
#include <rcl_interfaces/msg/parameter_descriptor.hpp>
#include <sensor_msgs/msg/nav_sat_fix.hpp>
#include <sensor_msgs/msg/point_cloud2.hpp>
#include <std_srvs/srv/set_bool__response.hpp>

namespace segue::ros2 {
namespace {

template <class Struct>
void expect_message(const std::string& name) {
  InterfaceLibrary library;
  type::TypeRegistry registry;
  const auto message = message_type(library, name, registry);
  ASSERT_TRUE(message) << to_string(message.error());
  const type::TypeInfo& info = type::type_info<Struct>();
  EXPECT_EQ(info.name(), (*message)->name);
  EXPECT_EQ(info.hash, type::structural_hash(**message)) << type::definition(*info.type);
  EXPECT_EQ(info.size, (*message)->size);
}

TEST(Ros2Headers, HaveTheStructsOfTheMessages) {
  expect_message<sensor_msgs::PointCloud2>("sensor_msgs/msg/PointCloud2");
  expect_message<nav_msgs::OccupancyGrid>("nav_msgs/msg/OccupancyGrid");
  expect_message<nav_msgs::Odometry>("nav_msgs/msg/Odometry");
  expect_message<rcl_interfaces::ParameterDescriptor>("rcl_interfaces/msg/ParameterDescriptor");
  expect_message<std_srvs::SetBool_Response>("std_srvs/srv/SetBool_Response");
}

TEST(Ros2Headers, HaveConstantsAndDefaults) {
  EXPECT_EQ(sensor_msgs::PointField::FLOAT64, 8);
  EXPECT_EQ(sensor_msgs::NavSatStatus{}.status, -2) << "its default";
  EXPECT_EQ(nav_msgs::Odometry{}.pose.pose.orientation.w, 1.0);
}

}  // namespace
}  // namespace segue::ros2

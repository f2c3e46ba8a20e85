// SPDX-License-Identifier: Apache-2.0
#include "studio_ros2.hpp"

#include <segue/type/json.hpp>

#include <gmock/gmock.h>
#include <support/environment_variable.hpp>
#include <support/temporary_files.hpp>

namespace segue::cli {
namespace {

using type::Value;

/// As a look has it.
Value node(const std::string& name, Value process) {
  const Value none = Value(Value::List());
  Value node = Value::map({{"name", name},
                           {"managed", false},
                           {"publishers", none},
                           {"subscriptions", none},
                           {"parameters", none},
                           {"problems", none}});
  if (!process.is_null()) node.as_map().set("process", std::move(process));
  return node;
}

TEST(StudioRos2, IsOfferedWhereTheComputerUsesIt) {
  const segue::testing::TemporaryFiles files;
  const segue::testing::EnvironmentVariable distribution("ROS_DISTRO", "");
  const segue::testing::EnvironmentVariable prefixes("AMENT_PREFIX_PATH", "");
  const segue::testing::EnvironmentVariable domain("ROS_DOMAIN_ID", "");
  EXPECT_FALSE(is_ros2_used(files.folder() / "ros"));
  std::filesystem::create_directories(files.folder() / "ros/jazzy");
  EXPECT_TRUE(is_ros2_used(files.folder() / "ros"));
  const segue::testing::EnvironmentVariable chosen("ROS_DOMAIN_ID", "7");
  EXPECT_TRUE(is_ros2_used(files.folder() / "none"));
}

TEST(StudioRos2, PagesGetNoCommandLines) {
  const Value process = Value::map(
      {{"pid", 7}, {"nodes", 1}, {"command", Value::list({"/opt/bin/talker", "--password", "geheim"})}});
  Value seen = Value::map({{"nodes", Value::list({node("/talker", process), node("/far", Value())})}});
  prepare_for_pages(seen);
  const Value& talker = seen.find("nodes")->as_list().at(0);
  EXPECT_EQ(*talker.find("process"), Value::map({{"pid", 7}, {"nodes", 1}, {"program", "talker"}}));
  EXPECT_THAT(type::to_json(seen), ::testing::Not(::testing::HasSubstr("geheim")));
  EXPECT_EQ(seen.find("nodes")->as_list().at(1).find("process"), nullptr);
}

TEST(StudioRos2, PagesGetNodesAsTasks) {
  Value seen = Value::map({{"nodes", Value::list({node("/robot/talker", Value()), node("/far", Value())})}});
  prepare_for_pages(seen);
  EXPECT_EQ(seen.find("nodes")->as_list().at(0).find("text")->as_string(),
            "tasks:\n"
            "  # its program is not known: it is not on this computer, or another user's\n"
            "  robot_talker:\n"
            "    component: ros2::Node\n"
            "    properties: {name: /robot/talker}\n");
}

}  // namespace
}  // namespace segue::cli

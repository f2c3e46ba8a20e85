// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/node_command.hpp>

#include <gmock/gmock.h>

namespace segue::ros2 {
namespace {

using Words = std::vector<std::string>;

TEST(NodeCommand, HasPackageAndExecutableOfTheInstallation) {
  EXPECT_EQ(parse_node_command({"/opt/ros/jazzy/lib/demo_nodes_cpp/talker"}),
            (NodeCommand{"/opt/ros/jazzy", "demo_nodes_cpp", "talker"}));
  EXPECT_EQ(parse_node_command({"/usr/bin/python3", "/home/a/ws/install/lib/my_pkg/node.py", "fast"}),
            (NodeCommand{"/home/a/ws/install", "my_pkg", "node.py", {}, {"fast"}}));
}

TEST(NodeCommand, HasRemappingsAndTheArgumentsThatAreNotForRos2) {
  const Words words = {"/opt/ros/jazzy/lib/nav/planner",
                       "--fast",
                       "--ros-args",
                       "-r",
                       "__node:=planner",
                       "-r",
                       "__ns:=/robot",
                       "--params-file",
                       "/tmp/launch_params_1",
                       "-r",
                       "/scan:=/front/scan",
                       "-p",
                       "rate:=10",
                       "--remap",
                       "odom:tf:=/tf2",
                       "--",
                       "map.yaml",
                       "--ros-args",
                       "--log-level",
                       "debug"};
  EXPECT_EQ(parse_node_command(words), (NodeCommand{"/opt/ros/jazzy",
                                                    "nav",
                                                    "planner",
                                                    {"/scan:=/front/scan", "odom:tf:=/tf2"},
                                                    {"--fast", "map.yaml"}}));
}

TEST(NodeCommand, OfOtherProgramsIsNone) {
  EXPECT_EQ(parse_node_command({"/usr/bin/talker"}), std::nullopt);
  EXPECT_EQ(parse_node_command({"lib/demo/talker"}), std::nullopt) << "the folder is not known";
  EXPECT_EQ(parse_node_command({"/usr/bin/python3", "talker.py"}), std::nullopt);
  EXPECT_EQ(parse_node_command({}), std::nullopt);
  EXPECT_EQ(parse_node_command({"/opt/lib/a/b", "--ros-args", "-r"})->remappings.size(), 0U)
      << "a rule is missing";
}

}  // namespace
}  // namespace segue::ros2

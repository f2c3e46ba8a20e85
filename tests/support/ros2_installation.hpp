// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/file.hpp>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace segue::testing {

/// An installation of ROS 2 named jazzy, in a folder, with two packages whose programs are all
/// components/ros2/peers/node_program.cpp. It is the only one on this computer while this lives.
class Ros2Installation {
 public:
  Ros2Installation(std::filesystem::path folder, const std::filesystem::path& program)
      : folder_(std::move(folder)) {
    namespace fs = std::filesystem;
    for (const char* name :
         {"test_nodes/managed", "test_nodes/talker", "test_nodes/counter", "test_nodes/listener",
          "test_nodes/fails", "test_nodes/stubborn", "rclcpp_components/component_container_isolated"}) {
      const fs::path link = folder_ / "jazzy/lib" / name;
      fs::create_directories(link.parent_path());
      fs::create_symlink(program, link);
    }
    write("jazzy/lib/libtest_nodes.so", "as if it were one");
    write("jazzy/share/ament_index/resource_index/rclcpp_components/test_nodes",
          "test::Managed;lib/libtest_nodes.so\ntest::Other;lib/libother.so\n");
    write("jazzy/setup.sh",
          "export AMENT_PREFIX_PATH='" + (folder_ / "jazzy").string() + "'\necho setup.sh was read\n");
    write("ros2.yaml",
          "installations:\n  jazzy: {prefix: jazzy, environment: {NODE_NOTES: " + folder_.string() + "}}\n");
    ::setenv("SEGUE_ROS2_INSTALLATIONS", (folder_ / "ros2.yaml").c_str(), 1);
  }
  ~Ros2Installation() { ::unsetenv("SEGUE_ROS2_INSTALLATIONS"); }
  Ros2Installation(const Ros2Installation&) = delete;
  Ros2Installation& operator=(const Ros2Installation&) = delete;

  void write(const std::string& file, const std::string& text) const {
    std::filesystem::create_directories((folder_ / file).parent_path());
    std::ofstream(folder_ / file) << text;
  }
  /// What a node has noted.
  [[nodiscard]] std::string noted(const std::string& name) const {
    return read_file(folder_ / name).value_or("(not noted)");
  }
  /// 0: there is none with that name.
  [[nodiscard]] pid_t pid_of(const std::string& node) const {
    return static_cast<pid_t>(std::atoi(noted(node + ".pid").c_str()));
  }

 private:
  const std::filesystem::path folder_;
};

}  // namespace segue::testing

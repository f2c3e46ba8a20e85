// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace ros2 {

/// A ROS 2 on this computer: a prefix such as /opt/ros/jazzy, or a workspace upon it.
struct Installation {
  std::string name;
  std::filesystem::path prefix;
  /// Variables that its setup.sh sets, and then the file of installations. Names are unique.
  std::vector<std::pair<std::string, std::string>> environment;

  /// Empty where there is none.
  [[nodiscard]] std::string_view variable(std::string_view name_of_it) const;
  /// Also one that is there already.
  void set_variable(const std::string& name_of_it, const std::string& value);

  /// The program of a package: PREFIX/lib/PACKAGE/EXECUTABLE, in this prefix or in those that it builds upon.
  /// NotFound names the programs that the package has.
  [[nodiscard]] segue::Result<std::filesystem::path> find_program(const std::string& package,
                                                                  const std::string& executable) const;
};

/// The installation with that name in this computer's file of installations, which is
/// $SEGUE_ROS2_INSTALLATIONS, otherwise $XDG_CONFIG_HOME/segue/ros2.yaml, ~/.config/segue/ros2.yaml or, for
/// root, /etc/segue/ros2.yaml:
///   installations:
///     jazzy: {prefix: /opt/ros/jazzy, environment: {RMW_IMPLEMENTATION: rmw_cyclonedds_cpp}}
/// Without such a file, those in /opt/ros are known by the names of their folders. An empty name: the only
/// one there is. Runs setup.sh once for each prefix, which takes a shell some 10 to 500 ms. NotFound,
/// ParseError; any thread.
segue::Result<Installation> find_installation(const std::string& name);

}  // namespace ros2

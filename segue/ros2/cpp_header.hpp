// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/ros2/interface_library.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace segue::ros2 {

/// A C++ header with the struct of a message, for components that have ports of it.
struct CppHeader {
  std::string path;  ///< as in ROS 2: "geometry_msgs/msg/point.hpp"
  std::string text;
};

/// The headers of the message and of all its parts; each includes those that it needs. The structs have the
/// names and members of ROS 2's C++ types, but for the namespace "msg", and are described for Segue. Fails as
/// message_type().
Result<std::vector<CppHeader>> cpp_headers(InterfaceLibrary& library, std::string_view name);

}  // namespace segue::ros2

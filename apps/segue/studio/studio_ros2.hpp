// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/base/wait.hpp>
#include <segue/type/value.hpp>
#include <segue/web/ros2_looks.hpp>

#include <filesystem>

namespace segue::cli {

/// As of web::LookAtRos2, by the program that `segue ros2` starts.
Result<type::Value> look_for_pages(const web::Ros2Place& place, const Wait& wait);

/// Whether ROS 2 is used on this computer, as far as the environment tells or a folder of `installations`: so
/// a look may show something whether or not the robot has components of ROS 2.
bool is_ros2_used(const std::filesystem::path& installations = "/opt/ros");

/// A look as pages get it: each node with its "text" as a task, and of its process "program" in place of the
/// command line, which may have secrets.
void prepare_for_pages(type::Value& seen);

}  // namespace segue::cli

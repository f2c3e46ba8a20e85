// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/base/wait.hpp>
#include <segue/type/value.hpp>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

namespace segue::cli {

/// Where and how long a running system of ROS 2 is looked at.
struct Ros2SystemOptions {
  std::optional<int> domain;  ///< nothing: as the environment says
  std::string discovery;      ///< empty: as the environment says
  Duration wait = std::chrono::seconds(3);
  Duration patience = std::chrono::seconds(5);
  std::size_t most_output = std::size_t{256} << 20;  ///< bytes that are taken of what the nodes tell
  std::filesystem::path program;                     ///< that looks; empty: the one that is installed
};

/// Whether the program that looks is installed.
bool can_look_at_ros2();

/// The nodes and topics of the running system, as the program segue-ros2 of the package of that name tells
/// them; it alone loads Fast DDS. `request` names what is asked of nodes: {all: true}, {nodes: [NODE]},
/// {types: true}, {containers: true}; {brief: true}: names only. Unavailable where the program is not
/// installed; DeadlineExceeded, Cancelled and ResourceExhausted where it was ended since the wait was over or
/// it told too much; else the error that it has. Ctrl-C, which ends this process, ends the program, too. Any
/// thread.
Result<type::Value> look_at_ros2(const Ros2SystemOptions& options, type::Value request,
                                 const Wait& wait = TimePoint::max());

}  // namespace segue::cli

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/model/network.hpp>

namespace segue::cli {

/// The problems of tasks that are topics or nodes of ROS 2, which the models of their components do not tell:
/// topics that are none, connections of ports that `publishes` and `subscribes` do not name, of topics whose
/// types differ, and of two ports that are one topic.
void check_ros2_ports(const model::Network& network, Diagnostics& diagnostics);

}  // namespace segue::cli

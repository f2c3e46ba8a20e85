// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/value.hpp>

#include <string>
#include <vector>

#include "../command.hpp"
#include "ros2_look.hpp"

namespace segue::cli {

/// --domain, --discovery, --wait; and where nodes are asked, --timeout.
void add_ros2_system_options(Verb& verb, Ros2SystemOptions& options, bool asks);

/// For completion: the names of nodes that a short look finds, but for hidden ones; none where it fails.
std::vector<std::string> ros2_node_names();

/// Says on standard error what of the system could not be looked at.
void print_problems(const type::Value& seen);

/// The list at `key` of a node or topic as "a, b".
std::string joined_names(const type::Value& list);

}  // namespace segue::cli

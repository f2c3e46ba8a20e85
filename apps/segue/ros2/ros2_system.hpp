// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/value.hpp>

#include <string>
#include <string_view>
#include <vector>

#include "../command.hpp"
#include "ros2_look.hpp"

namespace segue::cli {

/// --domain, --discovery, --wait; and where nodes are asked, --timeout.
void add_ros2_system_options(Verb& verb, Ros2SystemOptions& options, bool asks);

/// For completion: the names of what a short look finds, but for hidden ones; none where it fails. `list` and
/// `key` are those of its result: "nodes" and "name", "topics" and "topic".
std::vector<std::string> running_ros2_names(std::string_view list, std::string_view key);

/// Says on standard error what of the system could not be looked at.
void print_problems(const type::Value& seen);

/// The list at `key` of a node or topic as "a, b".
std::string joined_names(const type::Value& list);

}  // namespace segue::cli

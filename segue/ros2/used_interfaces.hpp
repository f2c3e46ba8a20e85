// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/ros2/told_interface.hpp>
#include <segue/type/value.hpp>

#include <map>
#include <string>
#include <vector>

namespace segue::ros2 {

/// The messages, services and actions of a node, one of describe_nodes(), each with the hashes that its
/// endpoints tell.
std::map<std::string, TypeHashes> used_interfaces(const type::Value& node);

/// The parts for which a node with these hashes can be asked, and which describe the interface together;
/// empty where it does not tell enough. rcl knows the types of publishers, subscriptions, services and
/// clients by their hashes, but not those of requests and responses, whose hashes are all that is told of
/// services before Lyrical.
std::vector<std::string> parts_to_ask(const std::string& interface, const TypeHashes& hashes);

}  // namespace segue::ros2

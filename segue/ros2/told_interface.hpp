// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/ros2/interface_definition.hpp>
#include <segue/type/value.hpp>

#include <string>
#include <string_view>
#include <vector>

/// Interfaces that a running node tells (type_description_interfaces/srv/GetTypeDescription).
namespace segue::ros2 {

/// The file of an interface.
struct InterfaceFile {
  std::string path;  ///< within a folder of interface packages: "my_msgs/msg/Label.msg"
  std::string text;
};

/// The files of a message and its parts, but for those that are built in with the same fields, from the
/// response of a node. The node's own text is taken where it has the fields that the node describes, since
/// descriptions have neither constants nor defaults. The response is untrusted. InvalidArgument: the node
/// refuses, or its description is malformed or not that of the hash.
Result<std::vector<InterfaceFile>> told_interface(const type::Value& response, std::string_view name,
                                                  std::string_view hash);

/// The text of a .msg file.
std::string message_text(const MessageDefinition& message);

}  // namespace segue::ros2

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/type/value.hpp>

#include <string>
#include <string_view>
#include <vector>

/// The topics of a node as a network file names them.
namespace segue::ros2 {

/// The topic that a node named "/robot/lidar" has under this name: that of its namespace for "scan", its own
/// one for "~/scan", and what the first rule that fits makes of it ("scan:=/front/scan"). InvalidArgument
/// where it is not a valid name.
Result<std::string> resolve_topic(std::string_view topic, std::string_view node,
                                  const std::vector<std::string>& remappings);

/// One entry of the properties `publishes` and `subscribes` of a node's task, as a map: "scan: TYPE" is short
/// for "scan: {type: TYPE}", and a topic that is not named has the name of the port. InvalidArgument.
Result<type::Value> topic_settings(const std::string& port, const type::Value& entry, std::string_view path);

/// A port of a node's task.
struct NodeTopic {
  std::string port;
  bool is_published = false;
  std::string topic;  ///< as resolve_topic() gives it
  std::string type;
};

/// Those of the properties of a node's task (`name`, `process`, `publishes`, `subscribes`). What is wrong in
/// them is left out.
std::vector<NodeTopic> topics_of_task(const type::Value& properties);

}  // namespace segue::ros2

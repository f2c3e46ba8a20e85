// SPDX-License-Identifier: Apache-2.0
#include "topic_task.hpp"

namespace ros2 {

TopicTask::TopicTask(segue::task::Direction direction, const std::string& port,
                     const segue::task::ComponentOptions& options)
    : NodeTask(options) {
  dynamic_ports(direction, port, "its type is the property type");
}

}  // namespace ros2

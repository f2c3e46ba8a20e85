// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace ros2 {

/// A node that a task is.
struct ShownNode {
  std::string name;          ///< "/robot/drive"
  std::uint64_t number = 0;  ///< of all nodes that there were
  friend bool operator==(const ShownNode&, const ShownNode&) = default;
};

/// By the ids of their tasks.
using ShownNodes = std::map<std::string, ShownNode>;

}  // namespace ros2

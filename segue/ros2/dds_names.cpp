// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/dds_names.hpp>

#include <segue/base/text.hpp>

namespace segue::ros2 {

std::string dds_type_name(std::string_view interface_name) {
  std::string text;
  const auto parts = split(interface_name, '/');
  for (std::size_t i = 0; i + 1 < parts.size(); ++i)
    text.append(parts[i]).append("::");
  return text.append("dds_::").append(parts.back()).append("_");
}

}  // namespace segue::ros2

// SPDX-License-Identifier: Apache-2.0
#include <segue/base/life_cycle.hpp>

#include <algorithm>
#include <cctype>

namespace segue {

std::optional<TaskState> task_state_from(std::string_view name) {
  auto same = [&](std::string_view candidate) {
    return std::ranges::equal(candidate, name, [](char a, char b) {
      return a == static_cast<char>(std::tolower(static_cast<unsigned char>(b)));
    });
  };
  for (std::size_t i = 0; i < kTaskStateNames.size(); ++i) {
    if (same(kTaskStateNames[i])) return static_cast<TaskState>(i);
  }
  return std::nullopt;
}

}  // namespace segue

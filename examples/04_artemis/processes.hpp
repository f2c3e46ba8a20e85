// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <set>
#include <string>

namespace demo {

/// The deployment processes that this program started, as the operating system shows them.
struct Processes {
  std::set<std::string> names;
  /// Pools of shared memory that they and this program have mapped: two for each process that lives.
  std::size_t pools = 0;
};
Processes look_at_processes();

}  // namespace demo

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <set>
#include <string>

namespace demo {

/// The deployment processes that this program started, as the operating system shows them.
struct Processes {
  std::set<std::string> names;
  /// The shared-memory pools that they and this program have mapped: two for each living process.
  std::size_t pools = 0;
};
Processes look_at_processes();

}  // namespace demo

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>
#include <string>

namespace segue::mission {

/// Tells the executions of a run apart. A concurrent run begins actions before it is known how often their
/// states have begun, so there the iterations of the loops around the state count instead, the outermost
/// first: "2.1".
struct Execution {
  std::string path;
  std::uint64_t iteration = 0;  ///< how often the state had begun before
  std::string loops{};          ///< concurrent runs; empty if there is no loop around it
  friend auto operator<=>(const Execution&, const Execution&) = default;
};

}  // namespace segue::mission

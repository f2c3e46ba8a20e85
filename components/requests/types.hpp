// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/describe.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace runtime {

/// The latest requests of tasks, as the operation `requests` answers.
struct RequestedControllers {
  std::uint64_t last = 0;  ///< the number of the newest request; numbers rise
  std::vector<std::string> controllers{};
};

}  // namespace runtime

SEGUE_TYPE(runtime::RequestedControllers, last, controllers)

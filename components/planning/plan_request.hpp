// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "types.hpp"

#include <segue/base/result.hpp>

namespace planning {

/// Null if the situation has no such box.
const BoxPose* box_of(const Situation& situation, std::int32_t id);

/// InvalidArgument, with what is wrong, unless all numbers are finite and in their ranges, lists have the
/// length that the arm demands, and boxes that are named are there. Any thread.
segue::Result<void> check(const PlanRequest& request);

}  // namespace planning

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/planner/ground_task.hpp>

#include <cstdint>
#include <vector>

namespace segue::planner::detail {

struct Found {
  std::vector<std::uint32_t> operators;
  std::uint64_t states = 0;  ///< that were looked at
};

/// Searches forward from the initial state, greedily by the cost of a relaxed plan (h_add; operators of the
/// relaxed plan are tried first). NotFound: no plan exists. DeadlineExceeded and ResourceExhausted: the
/// limits are reached.
Result<Found> search(const GroundTask& task, const Limits& limits);

}  // namespace segue::planner::detail

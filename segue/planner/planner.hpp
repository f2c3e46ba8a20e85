// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/pddl/pddl.hpp>

#include <cstddef>
#include <cstdint>
#include <stop_token>
#include <string>

/// A planner for PDDL problems of moderate size, where no other is at hand.
namespace segue::planner {

/// The limits of a search.
struct PlannerOptions {
  TimePoint deadline = TimePoint::max();
  std::stop_token stop;
  std::size_t memory = std::size_t{2} << 30U;  ///< bytes, roughly
};

/// A plan that was found.
struct Plan {
  std::string text;  ///< a step a line, "(drive a b)", and the cost as a comment, as read_pddl() takes it
  double cost = 0;   ///< the sum of what actions add to `total-cost`, or the number of steps
  std::uint64_t states = 0;  ///< that were looked at
};

/// Searches for a plan: some plan, not the best one. Durative actions are taken one after the other. The same
/// problem gives the same plan. Blocks. Errors: InvalidArgument, with all diagnostics, for a problem that
/// cannot be read, or with conditional effects and effects for all objects, which this planner does not
/// support; NotFound where no plan exists; DeadlineExceeded, also where it is stopped; ResourceExhausted.
Result<Plan> find_plan(const pddl::PddlText& domain, const pddl::PddlText& problem,
                       const PlannerOptions& options);

}  // namespace segue::planner

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/diagnostic.hpp>
#include <segue/base/result.hpp>
#include <segue/pddl/pddl_task.hpp>

#include <cstdint>
#include <stop_token>
#include <string>
#include <vector>

namespace segue::planner::detail {

using FactNumber = std::uint32_t;

/// An action with objects in place of its variables.
struct Operator {
  std::string step;  ///< "(drive a b)"
  double cost = 1;
  std::vector<FactNumber> needs;
  std::vector<FactNumber> adds;
  std::vector<FactNumber> deletes;  ///< none of `adds`
};

/// A task without variables. Its facts are those that may change, and the negations of those that an action
/// or the goal forbids, so nothing is forbidden any more.
struct GroundTask {
  std::uint32_t facts = 0;
  std::vector<FactNumber> initial;
  std::vector<FactNumber> goal;
  std::vector<Operator> operators;  ///< that can be reached if nothing is ever deleted
  bool goal_can_be_reached = true;  ///< if nothing is ever deleted
  bool has_costs = false;           ///< otherwise each operator costs 1
};

/// When to give up.
struct Limits {
  TimePoint deadline = TimePoint::max();
  std::stop_token stop;
  std::size_t memory = std::size_t{2} << 30U;  ///< bytes, roughly
  [[nodiscard]] bool are_reached() const { return stop.stop_requested() || monotonic_now() >= deadline; }
};

/// Finds the operators of a task that was read without errors. Timeout and ResourceExhausted where the limits
/// are reached, InvalidArgument for conditional effects and effects for all objects.
Result<GroundTask> ground(const pddl::detail::PddlTask& task, const Limits& limits);

}  // namespace segue::planner::detail

// SPDX-License-Identifier: Apache-2.0
#include "path_search.hpp"

#include <segue/base/mutex.hpp>

#include <ompl/base/ScopedState.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/PathSimplifier.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace planning {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;

constexpr unsigned kShortcuts = 60;  ///< attempts for each path that was found

Positions positions_of(const ob::State* state, std::size_t joints) {
  const double* const values = state->as<ob::RealVectorStateSpace::StateType>()->values;
  return {values, values + joints};
}

std::shared_ptr<ob::RealVectorStateSpace> space_of(const SearchSpace& space) {
  auto made = std::make_shared<ob::RealVectorStateSpace>(static_cast<unsigned>(space.limits.size()));
  ob::RealVectorBounds bounds(static_cast<unsigned>(space.limits.size()));
  for (unsigned joint = 0; joint < space.limits.size(); ++joint) {
    bounds.setLow(joint, space.limits[joint].first);
    bounds.setHigh(joint, space.limits[joint].second);
  }
  made->setBounds(bounds);
  // OMPL wants it as a part of the largest distance in the space.
  made->setLongestValidSegmentFraction(space.resolution / made->getMaximumExtent());
  return made;
}

/// One search after the other for the same start and goal.
class Searches {
 public:
  Searches(const SearchSpace& space, const Positions& start, const Positions& goal)
      : joints_(space.limits.size()), setup_(space_of(space)) {
    setup_.setStateValidityChecker([&space, joints = joints_](const ob::State* state) {
      return space.is_free(positions_of(state, joints));
    });
    setup_.setPlanner(std::make_shared<og::RRTConnect>(setup_.getSpaceInformation()));
    setup_.setStartAndGoalStates(scoped(start), scoped(goal), 1e-6);
    setup_.setup();
  }

  /// The next path, and how many steps were needed for it.
  std::pair<std::optional<std::vector<Positions>>, std::uint32_t> next(std::uint32_t most) {
    setup_.clear();
    std::uint32_t steps = 0;
    const ob::PlannerTerminationCondition enough([&] { return ++steps > most; });
    if (setup_.solve(enough) != ob::PlannerStatus::EXACT_SOLUTION) return {std::nullopt, steps};
    og::PathGeometric& path = setup_.getSolutionPath();
    if (path.getStateCount() > 2) {
      og::PathSimplifier simplifier(setup_.getSpaceInformation());
      simplifier.reduceVertices(path, kShortcuts, kShortcuts);
      simplifier.shortcutPath(path, kShortcuts, kShortcuts);
      simplifier.collapseCloseVertices(path, kShortcuts, kShortcuts);
      steps += kShortcuts;
    }
    std::vector<Positions> points;
    for (const ob::State* const state : path.getStates())
      points.push_back(positions_of(state, joints_));
    return {std::move(points), steps};
  }

 private:
  ob::ScopedState<> scoped(const Positions& positions) const {
    ob::ScopedState<> state(setup_.getStateSpace());
    for (std::size_t joint = 0; joint < joints_; ++joint)
      state[static_cast<unsigned>(joint)] = positions[joint];
    return state;
  }

  std::size_t joints_;
  og::SimpleSetup setup_;
};

}  // namespace

double cost_of(const std::vector<Positions>& path) {
  if (path.empty()) return std::numeric_limits<double>::infinity();
  double cost = 0;
  for (std::size_t point = 1; point < path.size(); ++point) {
    double farthest = 0;
    for (std::size_t joint = 0; joint < path[point].size(); ++joint)
      farthest = std::max(farthest, std::abs(path[point][joint] - path[point - 1][joint]));
    cost += farthest;
  }
  return cost;
}

std::optional<std::vector<Positions>> find_path(const SearchSpace& space, const Positions& start,
                                                const Positions& goal, const SearchBudget& budget) {
  if (!space.is_free(start) || !space.is_free(goal)) return std::nullopt;
  static segue::Mutex mutex;
  const segue::Lock lock(mutex);
  ompl::msg::noOutputHandler();
  ompl::RNG::setSeed(static_cast<std::uint_fast32_t>(budget.seed % 0x7fffffff + 1));
  Searches searches(space, start, goal);
  std::optional<std::vector<Positions>> best;
  for (std::uint32_t used = 0; used < budget.steps;) {
    auto [path, steps] = searches.next(budget.steps - used);
    used += std::max<std::uint32_t>(steps, 1);
    if (!path) continue;
    const bool straight = path->size() == 2;
    if (!best || cost_of(*path) < cost_of(*best)) best = std::move(path);
    if (straight || budget.first) break;
  }
  return best;
}

}  // namespace planning

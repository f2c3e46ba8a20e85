// SPDX-License-Identifier: Apache-2.0
#include <segue/convert/path_index.hpp>

#include <algorithm>
#include <utility>

namespace segue::convert {

namespace {

/// Joins, and edges that they stand for, that are looked at to find whether two edges never meet.
constexpr int kMostMeetings = 64;

}  // namespace

PathIndex::PathIndex(const PathConditions& paths) : places_(paths.size()) {
  for (std::uint32_t branch = 0; branch < places_.size(); ++branch) {
    Place& place = places_[branch];
    place.around = paths.around(branch);
    place.depth = depth(place.around) + 1;
    place.means = paths.means(branch);
    place.reached = paths.reached(branch);
    place.further = place.around;
    if (place.around.always()) continue;
    const Place& outer = places_[place.around.branch];
    place.join = is_join(place.around) ? place.around : outer.join;
    // Two jumps of one length in a row become one of both: this keeps ways logarithmic.
    const std::uint32_t landing = depth(outer.further);
    const BranchEdge beyond = outer.further.always() ? BranchEdge{} : places_[outer.further.branch].further;
    if (outer.depth - landing == landing - depth(beyond)) place.further = beyond;
  }
}

bool PathIndex::is_join(BranchEdge edge) const {
  return !edge.always() && !places_[edge.branch].means.empty() &&
         edge.outcome == places_[edge.branch].reached;
}

BranchEdge PathIndex::at_depth(BranchEdge edge, std::uint32_t wanted) const {
  while (depth(edge) > wanted) {
    const Place& place = places_[edge.branch];
    edge = depth(place.further) >= wanted ? place.further : place.around;
  }
  return edge;
}

bool PathIndex::implies(BranchEdge inner, BranchEdge outer) const {
  return depth(inner) >= depth(outer) && at_depth(inner, depth(outer)) == outer;
}

/// Whether they lie on different edges of one branch.
bool PathIndex::differ(BranchEdge a, BranchEdge b) const {
  const std::uint32_t common = std::min(depth(a), depth(b));
  a = at_depth(a, common);
  b = at_depth(b, common);
  while (!a.always() && a.branch != b.branch) {
    const Place& of_a = places_[a.branch];
    const Place& of_b = places_[b.branch];
    const bool jump = of_a.further.branch != of_b.further.branch;
    a = jump ? of_a.further : of_a.around;
    b = jump ? of_b.further : of_b.around;
  }
  return !a.always() && a.outcome != b.outcome;
}

bool PathIndex::never_meet(BranchEdge a, BranchEdge b) const {
  if (implies(a, b) || implies(b, a)) return false;
  int budget = kMostMeetings;
  return never_meet(a, b, budget);
}

bool PathIndex::never_meet(BranchEdge a, BranchEdge b, int& budget) const {
  if (differ(a, b)) return true;
  for (auto [one, other] : {std::pair(a, b), std::pair(b, a)}) {
    if (!is_join(one)) one = one.always() ? one : places_[one.branch].join;
    for (; !one.always() && --budget > 0; one = places_[one.branch].join) {
      const auto apart = [this, &budget, beside = other](BranchEdge edge) {
        return --budget > 0 && never_meet(edge, beside, budget);
      };
      if (std::ranges::all_of(places_[one.branch].means, apart)) return true;
    }
  }
  return false;
}

}  // namespace segue::convert

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/planner/ground_task.hpp>

#include <cstdint>
#include <queue>
#include <span>
#include <utility>
#include <vector>

namespace segue::planner::detail {

/// A set of facts, one bit for each.
using StateBits = std::vector<std::uint64_t>;
inline bool has_fact(std::span<const std::uint64_t> state, FactNumber fact) {
  return (state[fact / 64] >> (fact % 64) & 1U) != 0;
}

/// An estimate of what is missing to the goal: the cost of the additive heuristic, by which the cheapest
/// operator for each fact is chosen, summed over the operators of the relaxed plan that these form.
class Heuristic {
 public:
  explicit Heuristic(const GroundTask& task);

  /// The estimate; infinite where the goal cannot be reached from the state. Fills applicable() and
  /// preferred().
  double estimate(std::span<const std::uint64_t> state);
  /// The operators that can be carried out in the state.
  [[nodiscard]] const std::vector<std::uint32_t>& applicable() const { return applicable_; }
  /// Those of them that are in the relaxed plan.
  [[nodiscard]] const std::vector<std::uint32_t>& preferred() const { return preferred_; }

 private:
  static constexpr std::uint32_t kNobody = ~std::uint32_t{0};
  struct Waiting {
    double cost;
    FactNumber fact;
    bool operator>(const Waiting& other) const {
      return std::pair(cost, fact) > std::pair(other.cost, other.fact);
    }
  };

  void reach(FactNumber fact, double cost, std::uint32_t by);
  void trigger(std::uint32_t number);
  double relaxed_plan();

  const GroundTask& task_;
  std::vector<std::vector<std::uint32_t>> users_;  ///< by fact: operators that need it
  std::vector<double> costs_;                      ///< by fact
  std::vector<std::uint32_t> cheapest_;            ///< by fact: the operator that adds it
  std::vector<std::uint32_t> open_;                ///< by operator: needs that are not reached yet
  std::vector<double> sums_;                       ///< by operator: the costs of its needs
  std::vector<bool> is_planned_;                   ///< by operator
  std::priority_queue<Waiting, std::vector<Waiting>, std::greater<>> waiting_;
  std::vector<std::uint32_t> applicable_;
  std::vector<std::uint32_t> preferred_;
};

}  // namespace segue::planner::detail

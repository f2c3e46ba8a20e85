// SPDX-License-Identifier: Apache-2.0
#include <segue/planner/heuristic.hpp>

#include <algorithm>
#include <limits>

namespace segue::planner::detail {

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// Where operators differ in costs, also those that cost nothing count, so that plans do not become long.
double weight(const GroundTask& task, const Operator& each) {
  return task.has_costs ? each.cost + 1 : 1;
}

}  // namespace

Heuristic::Heuristic(const GroundTask& task)
    : task_(task),
      users_(task.facts),
      costs_(task.facts),
      cheapest_(task.facts),
      open_(task.operators.size()),
      sums_(task.operators.size()),
      is_planned_(task.operators.size()) {
  for (std::uint32_t i = 0; i < task.operators.size(); ++i) {
    for (const FactNumber fact : task.operators[i].needs)
      users_[fact].push_back(i);
  }
}

double Heuristic::estimate(std::span<const std::uint64_t> state) {
  std::ranges::fill(costs_, kNever);
  std::ranges::fill(cheapest_, kNobody);
  std::ranges::fill(sums_, 0);
  applicable_.clear();
  preferred_.clear();
  for (std::uint32_t i = 0; i < open_.size(); ++i)
    open_[i] = static_cast<std::uint32_t>(task_.operators[i].needs.size());
  for (FactNumber fact = 0; fact < task_.facts; ++fact) {
    if (has_fact(state, fact)) reach(fact, 0, kNobody);
  }
  for (std::uint32_t i = 0; i < open_.size(); ++i) {
    if (open_[i] == 0) trigger(i);
  }
  while (!waiting_.empty()) {
    const Waiting next = waiting_.top();
    waiting_.pop();
    if (next.cost > costs_[next.fact]) continue;
    for (const std::uint32_t user : users_[next.fact]) {
      sums_[user] += next.cost;
      if (--open_[user] == 0) trigger(user);
    }
  }
  for (std::uint32_t i = 0; i < open_.size(); ++i) {
    const auto& needs = task_.operators[i].needs;
    const bool ready = std::ranges::all_of(needs, [&](FactNumber fact) { return has_fact(state, fact); });
    if (ready) applicable_.push_back(i);
  }
  return relaxed_plan();
}

void Heuristic::reach(FactNumber fact, double cost, std::uint32_t by) {
  if (cost >= costs_[fact]) return;
  costs_[fact] = cost;
  cheapest_[fact] = by;
  waiting_.push({cost, fact});
}

void Heuristic::trigger(std::uint32_t number) {
  const Operator& each = task_.operators[number];
  for (const FactNumber fact : each.adds)
    reach(fact, sums_[number] + weight(task_, each), number);
}

double Heuristic::relaxed_plan() {
  std::vector<FactNumber> missing = task_.goal;
  std::vector<std::uint32_t> planned;
  double cost = 0;
  while (!missing.empty()) {
    const FactNumber fact = missing.back();
    missing.pop_back();
    if (costs_[fact] == kNever) {
      cost = kNever;
      break;
    }
    const std::uint32_t by = cheapest_[fact];
    if (by == kNobody || is_planned_[by]) continue;
    is_planned_[by] = true;
    planned.push_back(by);
    cost += weight(task_, task_.operators[by]);
    const auto& needs = task_.operators[by].needs;
    missing.insert(missing.end(), needs.begin(), needs.end());
  }
  for (const std::uint32_t each : planned) {
    is_planned_[each] = false;
    if (std::ranges::binary_search(applicable_, each)) preferred_.push_back(each);
  }
  return cost;
}

}  // namespace segue::planner::detail

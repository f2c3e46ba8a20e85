// SPDX-License-Identifier: Apache-2.0
#include <segue/convert/conversion_fault.hpp>
#include <segue/convert/path_conditions.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace segue::convert {

using task_network::kNone;
using task_network::NodeId;
using task_network::OutcomeId;

namespace {

/// The most conditions at a node: more add little to the order and cost memory.
constexpr std::size_t kMostConditions = 8;
/// Joins of more edges are not expanded.
constexpr std::size_t kMostEdges = 64;

}  // namespace

std::uint32_t PathConditions::add(NodeId node, BranchEdge around, std::shared_ptr<const BranchEnds> ends,
                                  std::optional<OutcomeId> expected) {
  const auto number = static_cast<std::uint32_t>(branches_.size());
  Branch& branch = branches_.emplace_back();
  branch.node = node;
  branch.around = around;
  branch.depth = depth(around) + 1;
  branch.ends = std::move(ends);
  branch.expected = expected;
  by_node_.resize(std::max<std::size_t>(by_node_.size(), index(node) + 1), kNone);
  by_node_[index(node)] = number;
  return number;
}

BranchEdge PathConditions::add_join(NodeId node, BranchEdge around, std::vector<BranchEdge> edges,
                                    OutcomeId reached, OutcomeId missed) {
  const bool likely =
      std::ranges::any_of(edges, [&](const BranchEdge& edge) { return expected(edge, around); });
  double reaches = 0;
  for (const BranchEdge& edge : edges)
    reaches += likelihood(edge, around);
  if (join_ends_ == nullptr) join_ends_ = std::make_shared<BranchEnds>(BranchEnds{{reached, missed}, {}});
  const std::uint32_t number = add(node, around, join_ends_, likely ? std::nullopt : std::optional(missed));
  branches_[number].reaches = std::min(reaches, 1.0);
  branches_[number].narrows =
      !std::ranges::all_of(edges, [&](const BranchEdge& edge) { return implies(edge, around); });
  branches_[number].meaning = std::move(edges);
  return {number, reached};
}

/// How likely the branch ends with the outcome of the edge, if it is on the path.
double PathConditions::likelihood(BranchEdge edge) const {
  const Branch& branch = branches_[edge.branch];
  if (branch.decided) return *branch.decided == edge.outcome ? 1 : 0;
  const auto& outcomes = branch.ends->outcomes;
  if (branch.ends == join_ends_)
    return edge.outcome == outcomes.front() ? branch.reaches : 1 - branch.reaches;
  const auto outcome = std::ranges::find(outcomes, edge.outcome) - outcomes.begin();
  return branch.ends->likelihoods[static_cast<std::size_t>(outcome)];
}

/// How likely the edge is on the path, if `outer`, which it implies, is.
double PathConditions::likelihood(BranchEdge edge, BranchEdge outer) const {
  double product = 1;
  for (; !edge.always() && edge != outer; edge = branches_[edge.branch].around)
    product *= likelihood(edge);
  return product;
}

void PathConditions::decide(NodeId node, OutcomeId outcome) {
  if (index(node) >= by_node_.size() || by_node_[index(node)] == kNone) return;
  Branch& branch = branches_[by_node_[index(node)]];
  branch.decided = planted(ConversionFault::DecidesAsExpected) ? branch.expected.value_or(outcome) : outcome;
  ++changes_;
}

std::optional<BranchEdge> PathConditions::live_within(BranchEdge edge) {
  // Outwards up to a certain edge, then back, so that every branch on the way knows its enclosing edge.
  std::vector<std::uint32_t>& way = way_;
  way.clear();
  for (BranchEdge at = edge; !at.always(); at = branches_[at.branch].around) {
    const Branch& branch = branches_[at.branch];
    if (branch.dead || (branch.decided && *branch.decided != at.outcome)) {
      for (const std::uint32_t within : way)
        branches_[within].dead = true;
      return std::nullopt;
    }
    if (branch.live_at == changes_) break;
    way.push_back(at.branch);
  }
  for (auto number = way.rbegin(); number != way.rend(); ++number) {
    Branch& branch = branches_[*number];
    while (!branch.around.always() && branches_[branch.around.branch].decided)
      branch.around = branches_[branch.around.branch].around;
    branch.depth = depth(branch.around) + 1;
    branch.live_at = changes_;
  }
  while (!edge.always() && branches_[edge.branch].decided)
    edge = branches_[edge.branch].around;
  return edge;
}

bool PathConditions::off_path(BranchEdge edge) {
  for (BranchEdge at = edge; !at.always(); at = branches_[at.branch].around) {
    Branch& join = branches_[at.branch];
    if (!join.narrows || join.decided || at.outcome != join.ends->outcomes.front()) continue;
    if (join.dead) break;
    join.dead = std::ranges::none_of(join.meaning, [this](BranchEdge way) { return live(way).has_value(); });
    if (join.dead) ++changes_;
  }
  return !live(edge);
}

bool PathConditions::implies(BranchEdge inner, BranchEdge outer) {
  if (outer.always()) return true;
  while (depth(inner) > depth(outer))
    inner = branches_[inner.branch].around;
  return inner == outer;
}

bool PathConditions::exclude(BranchEdge a, BranchEdge b) {
  while (!a.always() && !b.always() && a.branch != b.branch) {
    BranchEdge& deeper = depth(a) >= depth(b) ? a : b;
    deeper = branches_[deeper.branch].around;
  }
  return !a.always() && !b.always() && a.outcome != b.outcome;
}

bool PathConditions::expected(BranchEdge edge, BranchEdge outer) {
  for (; !edge.always() && edge != outer; edge = branches_[edge.branch].around) {
    const Branch& branch = branches_[edge.branch];
    if (!branch.decided &&
        (edge.outcome == task_network::kAborted || branch.expected.value_or(edge.outcome) != edge.outcome))
      return false;
  }
  return true;
}

BranchEdge PathConditions::common(BranchEdge a, BranchEdge b) {
  while (a != b) {
    BranchEdge& deeper = depth(a) >= depth(b) ? a : b;
    deeper = branches_[deeper.branch].around;
  }
  return a;
}

/// Removes edges within others, and replaces all edges of one branch by its enclosing edge. False if nothing
/// changed.
bool PathConditions::reduce(std::vector<BranchEdge>& edges) {
  for (std::size_t i = 0; i < edges.size(); ++i) {
    for (std::size_t j = 0; j < edges.size(); ++j) {
      if (i == j || !implies(edges[i], edges[j])) continue;
      edges.erase(edges.begin() + static_cast<std::ptrdiff_t>(i));
      return true;
    }
  }
  for (const BranchEdge edge : edges) {
    if (edge.always()) continue;
    const Branch& branch = branches_[edge.branch];
    const auto ways = std::ranges::count(edges, edge.branch, &BranchEdge::branch);
    const bool all = (planted(ConversionFault::MergesHalfBranches) && ways > 1) ||
                     std::ranges::all_of(branch.ends->outcomes, [&](OutcomeId outcome) {
                       return std::ranges::find(edges, BranchEdge{edge.branch, outcome}) != edges.end();
                     });
    if (!all) continue;
    const BranchEdge around = live(branch.around).value_or(branch.around);
    std::erase_if(edges, [&](const BranchEdge& other) { return other.branch == edge.branch; });
    edges.push_back(around);
    return true;
  }
  return false;
}

/// Replaces one join by its edges.
bool PathConditions::expand(std::vector<BranchEdge>& edges) {
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (edges[i].always()) continue;
    const Branch& branch = branches_[edges[i].branch];
    if (branch.meaning.empty() || branch.narrows || edges[i].outcome != branch.ends->outcomes.front())
      continue;
    const std::vector<BranchEdge> meaning = branch.meaning;
    edges.erase(edges.begin() + static_cast<std::ptrdiff_t>(i));
    for (const BranchEdge edge : meaning) {
      if (const auto there = live(edge)) edges.push_back(*there);
    }
    return true;
  }
  return false;
}

std::optional<BranchEdge> PathConditions::merged(std::vector<BranchEdge> edges) {
  if (edges.size() == 1) return edges.front();
  for (;;) {
    if (edges.size() > kMostEdges) return std::nullopt;
    while (reduce(edges)) {
    }
    if (edges.size() == 1) return edges.front();
    if (!expand(edges)) return std::nullopt;
  }
}

std::vector<task_network::Condition> PathConditions::conditions(BranchEdge edge) {
  std::vector<task_network::Condition> result;
  if (planted(ConversionFault::IgnoresInnerBranch) && !edge.always()) edge = branches_[edge.branch].around;
  for (; !edge.always() && result.size() < kMostConditions; edge = branches_[edge.branch].around) {
    if (branches_[edge.branch].decided) continue;
    const double parts = std::round(likelihood(edge) * task_network::Condition::kCertain);
    result.push_back({branches_[edge.branch].node, edge.outcome, static_cast<std::uint16_t>(parts)});
  }
  std::ranges::sort(result);
  return result;
}

}  // namespace segue::convert

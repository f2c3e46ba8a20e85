// SPDX-License-Identifier: Apache-2.0
#include <segue/solve/hash_index.hpp>
#include <segue/solve/sequence.hpp>

#include <algorithm>

namespace segue::solve::detail {

namespace {

/// Tarjan's algorithm for strongly connected components (SIAM J. Comput. 1(2), 1972) along the edges
/// backwards: it completes a component after all those before it. With a stack of its own, since a chain of
/// tasks can be as long as a network.
class Components {
 public:
  Components(int nodes, const std::vector<OrderEdge>& edges)
      : before_(nodes, edges), entered_(as_index(nodes), kNone), low_(as_index(nodes)) {
    found_.nodes.reserve(as_index(nodes));
    found_.group_of.assign(as_index(nodes), kNone);
  }

  GroupedOrder find() {
    for (int node = 0; as_index(node) < entered_.size(); ++node) {
      if (entered_[as_index(node)] == kNone) explore(node);
    }
    return std::move(found_);
  }

 private:
  struct Visit {
    int node;
    int next;  ///< place of the next predecessor to look at
  };

  void explore(int root) {
    enter(root);
    while (!visits_.empty()) {
      Visit& visit = visits_.back();
      if (visit.next == before_.start(visit.node + 1)) {
        leave(visit.node);
      } else {
        visit_next(visit.node, before_.at(visit.next++));
      }
    }
  }

  void enter(int node) {
    entered_[as_index(node)] = low_[as_index(node)] = clock_++;
    open_.push_back(node);
    visits_.push_back({node, before_.start(node)});
  }

  void visit_next(int node, int other) {
    if (entered_[as_index(other)] == kNone) {
      enter(other);
    } else if (found_.group_of[as_index(other)] == kNone) {
      low_[as_index(node)] = std::min(low_[as_index(node)], entered_[as_index(other)]);
    }
  }

  void leave(int node) {
    visits_.pop_back();
    if (!visits_.empty()) {
      int& low = low_[as_index(visits_.back().node)];
      low = std::min(low, low_[as_index(node)]);
    }
    if (low_[as_index(node)] == entered_[as_index(node)]) close_group(node);
  }

  void close_group(int first) {
    const auto from = std::find(open_.rbegin(), open_.rend(), first).base() - 1;
    std::sort(from, open_.end());
    for (auto node = from; node != open_.end(); ++node) {
      found_.group_of[as_index(*node)] = groups_;
      found_.nodes.push_back(*node);
    }
    ++groups_;
    open_.erase(from, open_.end());
  }

  Predecessors before_;
  std::vector<int> entered_;
  std::vector<int> low_;
  std::vector<int> open_;  ///< entered, of no group yet
  std::vector<Visit> visits_;
  GroupedOrder found_;
  int clock_ = 0;
  int groups_ = 0;
};

}  // namespace

Predecessors::Predecessors(int nodes, const std::vector<OrderEdge>& edges)
    : starts_(static_cast<std::size_t>(nodes) + 2), before_(edges.size()) {
  for (const OrderEdge& edge : edges)
    ++starts_[as_index(edge.after) + 2];
  for (std::size_t i = 2; i < starts_.size(); ++i)
    starts_[i] += starts_[i - 1];
  for (const OrderEdge& edge : edges)
    before_[as_index(starts_[as_index(edge.after) + 1]++)] = edge.before;
}

GroupedOrder sequence(int nodes, const std::vector<OrderEdge>& edges) {
  return Components(nodes, edges).find();
}

}  // namespace segue::solve::detail

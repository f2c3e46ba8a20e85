// SPDX-License-Identifier: Apache-2.0
#include <segue/convert/weak_order.hpp>

#include <algorithm>
#include <utility>

namespace segue::convert {

namespace {

using Vertex = std::uint32_t;

/// Finds strongly connected components, removes the head of each, and decomposes the rest again. Nothing
/// recurses, so depth costs memory only.
class Builder {
 public:
  Builder(const std::vector<std::vector<Vertex>>& successors, WeakOrder& order)
      : successors_(successors), order_(order), part_(successors.size(), 0), marks_(successors.size()) {}

  void build(Vertex start) {
    visit(start);
    put_off();
    while (!open_.empty()) {
      const Work work = std::move(open_.back());
      open_.pop_back();
      if (work.vertices.empty()) {
        order_.end[work.head] = static_cast<Vertex>(order_.vertices.size());
      } else {
        take(work);
      }
    }
  }

 private:
  /// A component that is still to be ordered, its head first; or, without vertices, the end of the loop whose
  /// head has the place `head`.
  struct Work {
    std::vector<Vertex> vertices;
    Vertex head = 0;
  };
  struct Mark {
    std::uint32_t index = 0;  ///< 0: not visited
    std::uint32_t low = 0;
    bool on_stack = false;
  };
  struct Visit {
    Vertex vertex;
    std::size_t next;
  };
  static constexpr std::uint32_t kTaken = static_cast<std::uint32_t>(-1);

  void take(const Work& component) {
    const Vertex head = component.vertices.front();
    const auto place = static_cast<Vertex>(order_.vertices.size());
    order_.place[head] = place;
    order_.vertices.push_back(head);
    order_.end.push_back(0);
    part_[head] = kTaken;
    const auto& next = successors_[head];
    const bool loop = component.vertices.size() > 1 || std::ranges::find(next, head) != next.end();
    if (!loop) return;
    open_.push_back({{}, place});
    ++part_number_;
    for (const Vertex vertex : component.vertices) {
      if (vertex == head) continue;
      part_[vertex] = part_number_;
      marks_[vertex] = {};
    }
    for (const Vertex vertex : next) {
      if (part_[vertex] == part_number_ && marks_[vertex].index == 0) visit(vertex);
    }
    put_off();
  }

  /// Tarjan's algorithm, from `root`, within the current part.
  void visit(Vertex root) {
    std::vector<Visit> visits = {{root, 0}};
    begin(root);
    while (!visits.empty()) {
      auto& [vertex, next] = visits.back();
      if (next < successors_[vertex].size()) {
        const Vertex to = successors_[vertex][next++];
        if (part_[to] != part_number_) continue;
        if (marks_[to].index == 0) {
          begin(to);
          visits.push_back({to, 0});
        } else if (marks_[to].on_stack) {
          marks_[vertex].low = std::min(marks_[vertex].low, marks_[to].index);
        }
        continue;
      }
      const Vertex done = vertex;
      visits.pop_back();
      if (!visits.empty()) {
        Mark& around = marks_[visits.back().vertex];
        around.low = std::min(around.low, marks_[done].low);
      }
      if (marks_[done].low == marks_[done].index) close(done);
    }
  }

  void begin(Vertex vertex) {
    marks_[vertex] = {++index_, index_, true};
    stack_.push_back(vertex);
  }

  /// A component is complete; its first visited vertex is its entry.
  void close(Vertex head) {
    Work component{{head}, 0};
    for (;;) {
      const Vertex vertex = stack_.back();
      stack_.pop_back();
      marks_[vertex].on_stack = false;
      if (vertex == head) break;
      component.vertices.push_back(vertex);
    }
    found_.push_back(std::move(component));
  }

  /// Components are found last one first, which is the order for a stack.
  void put_off() {
    std::ranges::move(found_, std::back_inserter(open_));
    found_.clear();
  }

  const std::vector<std::vector<Vertex>>& successors_;
  WeakOrder& order_;
  std::vector<std::uint32_t> part_;  ///< by vertex: the component in which it was found last
  std::vector<Mark> marks_;
  std::vector<Vertex> stack_;
  std::vector<Work> found_;
  std::vector<Work> open_;
  std::uint32_t part_number_ = 0;
  std::uint32_t index_ = 0;
};

}  // namespace

WeakOrder weak_order(const std::vector<std::vector<std::uint32_t>>& successors, std::uint32_t start) {
  WeakOrder order;
  order.place.assign(successors.size(), WeakOrder::kUnreached);
  Builder(successors, order).build(start);
  return order;
}

}  // namespace segue::convert

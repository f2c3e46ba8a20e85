// SPDX-License-Identifier: Apache-2.0
#include <segue/draw/mission_gantt.hpp>

#include <algorithm>
#include <unordered_map>
#include <utility>
#include <vector>

namespace segue::draw {

namespace {

using mission::History;
using mission::StateKind;
using task_network::kNone;

task_network::NodeStatus status_of(const History::Item& item) {
  if (!item.ended) return task_network::NodeStatus::NotReached;
  if (item.outcome == mission::kAborted) return task_network::NodeStatus::Failed;
  return item.outcome == mission::kPreempted ? task_network::NodeStatus::Preempted
                                             : task_network::NodeStatus::Done;
}

class MachineGantt {
 public:
  MachineGantt(const mission::Program& program, const History& history, TimePoint begin, TimePoint end)
      : program_(program), history_(history), begin_(begin), end_(end), places_(history.items().size()) {}

  Gantt make(const mission::Outcome& outcome) {
    gantt_.name = program_.mission().name;
    gantt_.outcome = program_.outcome_name(0, outcome);
    gantt_.makespan = end_ - begin_;
    for (std::uint32_t i = 0; i < items().size(); ++i)
      places_[i].watches = watches(i);
    find_ends();
    for (std::uint32_t i = 0; i < items().size(); ++i) {
      places_[i].before = leaf_before(i);
      if (mission::is_leaf(program_.node(items()[i].state).kind)) add(i);
    }
    mark_critical();
    gantt_.arrange();
    return std::move(gantt_);
  }

 private:
  /// The leaves of an item: the last leaf in it to end, the leaf whose end let it begin, and its node;
  /// whether it only watched.
  struct Place {
    std::uint32_t last = kNone;
    std::uint32_t before = kNone;
    std::uint32_t node = kNone;
    bool watches = false;
  };

  [[nodiscard]] const std::vector<History::Item>& items() const { return history_.items(); }
  [[nodiscard]] TimePoint end_of(std::uint32_t item) const {
    return items()[item].ended ? items()[item].end : end_;
  }

  /// Items come after their containers, so the walk is from the end. Others did not wait for a state that was
  /// preempted because another one had ended.
  void find_ends() {
    for (auto i = static_cast<std::uint32_t>(items().size()); i-- > 0;) {
      const History::Item& item = items()[i];
      if (mission::is_leaf(program_.node(item.state).kind)) places_[i].last = i;
      if (item.parent == History::kNone || places_[i].last == kNone) continue;
      if (places_[i].watches && !places_[item.parent].watches) continue;
      std::uint32_t& around = places_[item.parent].last;
      if (around == kNone || end_of(places_[i].last) > end_of(around)) around = places_[i].last;
    }
  }

  /// In a hierarchy, the last leaf of the previous child; for a decider, the last leaf of its siblings;
  /// otherwise the leaf that let the container begin.
  std::uint32_t leaf_before(std::uint32_t i) {
    const History::Item& item = items()[i];
    if (item.parent == History::kNone) return kNone;
    const StateKind kind = program_.node(items()[item.parent].state).kind;
    std::uint32_t& latest = latest_[item.parent];
    const bool follows = kind == StateKind::Hierarchy || program_.node(item.state).kind == StateKind::Decider;
    const std::uint32_t before = follows && latest > 0 ? places_[latest].last : places_[item.parent].before;
    // Item 0 is the root, which is never a child, so 0 means none.
    const auto end_in = [&](std::uint32_t one) {
      return places_[one].last == kNone ? TimePoint{} : end_of(places_[one].last);
    };
    if (kind == StateKind::Hierarchy || latest == 0 || end_in(i) > end_in(latest)) latest = i;
    return before == kNone ? places_[item.parent].before : before;
  }

  /// Whether it is part of a branch that its preemptive container preempted when another branch ended: a
  /// watchdog, whose time is not work.
  [[nodiscard]] bool watches(std::uint32_t i) const {
    const History::Item& item = items()[i];
    if (item.parent == History::kNone) return false;
    const auto is_preempted = [](const History::Item& one) {
      return one.ended && one.outcome == mission::kPreempted;
    };
    const History::Item& around = items()[item.parent];
    const bool lost = program_.node(around.state).kind == StateKind::Preemptive && is_preempted(item) &&
                      !is_preempted(around);
    return lost || places_[item.parent].watches;
  }

  void add(std::uint32_t i) {
    const History::Item& item = items()[i];
    const mission::Action& action = program_.mission().actions[program_.node(item.state).action];
    const TimePoint from = since_begin(item.began);
    const TimePoint until = since_begin(end_of(i));
    Gantt::Node node;
    node.name = history_.path(program_, i);
    if (node.name.empty()) node.name = gantt_.name;
    if (item.iteration > 0) node.name += '#' + std::to_string(item.iteration);
    node.kind = action.action_class();
    node.status = status_of(item);
    if (item.ended) node.outcome = program_.outcome_name(item.state, item.outcome);
    if (places_[i].before != kNone) node.waits.push_back(wait_for(places_[i].before, from));
    if (const History::UnitWait* wait = history_.unit_wait(i)) {
      node.waits.push_back({task_network::Wait::Kind::Resource, task_network::NodeId{kNone}, wait->resource,
                            since_begin(wait->from), since_begin(wait->until)});
    }
    for (const mission::ResourceUse& use : action.resources)
      use_resource(node, use.resource);
    if (!places_[i].watches) gantt_.summary.sequential += until - from;
    places_[i].node = static_cast<std::uint32_t>(gantt_.nodes.size());
    gantt_.bars.push_back({places_[i].node, from, until});
    gantt_.nodes.push_back(std::move(node));
  }

  void use_resource(Gantt::Node& node, const std::string& name) {
    const auto [known, added] = resources_.emplace(name, static_cast<std::uint32_t>(gantt_.resources.size()));
    if (added) gantt_.resources.push_back({name});
    if (std::ranges::find(node.resources, known->second) == node.resources.end())
      node.resources.push_back(known->second);
  }

  /// The wait begins when the previous leaf began.
  [[nodiscard]] task_network::Wait wait_for(std::uint32_t before, TimePoint until) const {
    const History::Item& item = items()[before];
    return {task_network::Wait::Kind::Condition, task_network::NodeId{places_[before].node},
            program_.outcome_name(item.state, item.outcome), since_begin(item.began), until};
  }

  void mark_critical() {
    if (items().empty()) return;
    for (std::uint32_t leaf = places_[0].last; leaf != kNone; leaf = places_[leaf].before) {
      gantt_.nodes[places_[leaf].node].critical = true;
      gantt_.summary.critical_path += end_of(leaf) - items()[leaf].began;
    }
    gantt_.summary.shortest = gantt_.summary.critical_path;
  }

  [[nodiscard]] TimePoint since_begin(TimePoint when) const { return TimePoint{} + (when - begin_); }

  const mission::Program& program_;
  const History& history_;
  const TimePoint begin_;
  const TimePoint end_;
  std::vector<Place> places_;                                ///< by item
  std::unordered_map<std::uint32_t, std::uint32_t> latest_;  ///< by item: the child that ends last so far
  std::unordered_map<std::string, std::uint32_t> resources_;
  Gantt gantt_;
};

}  // namespace

Gantt gantt_of(const mission::Program& program, const mission::History& history,
               const mission::Outcome& outcome, TimePoint begin, TimePoint end) {
  return MachineGantt(program, history, begin, end).make(outcome);
}

}  // namespace segue::draw

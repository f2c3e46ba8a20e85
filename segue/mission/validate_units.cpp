// SPDX-License-Identifier: Apache-2.0
//
// Units that are certain to be used up when a state begins, whatever way leads there. A bound from below: of
// states side by side only one is taken to have done something, and an action that aborts nothing.
#include <segue/base/text.hpp>
#include <segue/mission/checks.hpp>
#include <segue/mission/units.hpp>

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <queue>
#include <unordered_map>
#include <utility>

namespace segue::mission::detail {
namespace {

/// The units of the resource that the action must find.
std::int64_t needed(const Action& action, const std::string& resource) {
  std::int64_t taken = 0;
  std::int64_t there = 0;
  for (const ResourceUse& use : action.resources) {
    if (use.resource != resource || use.operation == ResourceOperation::Release) continue;
    if (use.operation == ResourceOperation::Exists)
      there = std::max<std::int64_t>(there, use.count);
    else
      taken += use.count;
  }
  return std::max(taken, there);
}

/// The beginnings and the ends of all states as vertices of a graph. Edges are what may follow; they cost the
/// units of a resource that are certainly used up on the way.
class UsedUp {
 public:
  explicit UsedUp(const MissionIndex& index) : index_(index), mission_(index.mission()) {
    for (StateIndex i = 0; i < mission_.states.size(); ++i) {
      first_.push_back(static_cast<std::uint32_t>(state_of_.size()));
      state_of_.resize(state_of_.size() + kOwn + outcomes(i).size(), i);
      if (mission_.states[i].kind == StateKind::Library)
        users_[index_.library(mission_.states[i].library)->root].push_back(i);
    }
  }

  /// Finds the fewest units of the resource, of which there are so many, that are gone when each state
  /// begins.
  void find(const std::string& resource, std::int64_t count) {
    count_ = count;
    gone_.assign(state_of_.size(), kNever);
    reach(first_[0], 0);
    while (!open_.empty()) {
      const auto [gone, vertex] = open_.top();
      open_.pop();
      if (gone == gone_[vertex]) follow(vertex, gone, resource);
    }
  }
  /// Nothing if no way leads to the state.
  [[nodiscard]] std::optional<std::int64_t> gone_before(StateIndex state) const {
    const std::int64_t gone = gone_[first_[state]];
    return gone == kNever ? std::nullopt : std::optional(gone);
  }

 private:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
  static constexpr std::uint32_t kAbort = 1;  ///< vertices of a state; 0 is its beginning
  static constexpr std::uint32_t kPreempt = 2;
  static constexpr std::uint32_t kOwn = 3;  ///< the first of its own outcomes

  [[nodiscard]] const std::vector<std::string>& outcomes(StateIndex state) const {
    return *index_.interface(state)->outcomes;
  }

  void reach(std::uint32_t vertex, std::int64_t gone) {
    if (gone >= gone_[vertex]) return;
    gone_[vertex] = gone;
    open_.emplace(gone, vertex);
  }

  void reach_end(StateIndex state, std::string_view outcome, std::int64_t gone) {
    const auto& own = outcomes(state);
    const auto found = std::ranges::find(own, outcome);
    if (outcome == kAbortedName) return reach(first_[state] + kAbort, gone);
    if (outcome == kPreemptedName) return reach(first_[state] + kPreempt, gone);
    if (found != own.end())
      reach(first_[state] + kOwn + static_cast<std::uint32_t>(found - own.begin()), gone);
  }

  void follow(std::uint32_t vertex, std::int64_t gone, const std::string& resource) {
    const StateIndex state = state_of_[vertex];
    const std::uint32_t what = vertex - first_[state];
    if (what == 0) return begin(state, gone, resource);
    const auto name = what == kAbort     ? kAbortedName
                      : what == kPreempt ? kPreemptedName
                                         : std::string_view(outcomes(state)[what - kOwn]);
    end(state, name, gone);
  }

  void begin(StateIndex state, std::int64_t gone, const std::string& resource) {
    const State& entered = mission_.states[state];
    reach_end(state, kPreemptedName, gone);
    if (is_leaf(entered.kind)) return execute(state, gone, resource);
    if (entered.kind == StateKind::Library) return reach(first_[index_.library(entered.library)->root], gone);
    if (entered.kind != StateKind::Hierarchy) {
      for (const StateIndex child : entered.children)
        reach(first_[child], gone);
    } else if (entered.start) {
      lead(state, *entered.start, gone);
    }
  }

  void execute(StateIndex state, std::int64_t gone, const std::string& resource) {
    const Action& action = *index_.action_of(state);
    reach_end(state, kAbortedName, gone);
    if (needed(action, resource) > count_ - gone) return;
    for (const std::string& outcome : action.outcomes) {
      std::int64_t used = 0;
      for (const ResourceUse& use : action.resources) {
        const bool removes =
            use.operation == ResourceOperation::Consume ||
            (use.operation == ResourceOperation::Delete && outcome == action.foreseen_outcome());
        if (removes && use.resource == resource) used += use.count;
      }
      reach_end(state, outcome, gone + used);
    }
  }

  void lead(StateIndex container, const Target& to, std::int64_t gone) {
    if (to.leaves()) return reach_end(container, to.outcome, gone);
    reach(first_[index_.child(container, to.state)], gone);
  }

  void end(StateIndex state, std::string_view outcome, std::int64_t gone) {
    const StateIndex around = mission_.states[state].parent;
    if (around == kNoState) {
      for (const StateIndex user : users_[state])
        reach_end(user, outcome, gone);
      return;
    }
    for (const StateIndex beside : mission_.states[around].children) {
      if (mission_.states[beside].kind == StateKind::Decider) reach(first_[beside], gone);
    }
    const auto& transitions = mission_.states[state].transitions;
    const auto found = std::ranges::find(transitions, outcome, &StateTransition::outcome);
    if (found != transitions.end()) return lead(around, found->to, gone);
    reach_end(around, outcome, gone);
  }

  const MissionIndex& index_;
  const Mission& mission_;
  std::int64_t count_ = 0;
  std::vector<std::uint32_t> first_;                               ///< by state: its first vertex
  std::vector<StateIndex> state_of_;                               ///< by vertex
  std::unordered_map<StateIndex, std::vector<StateIndex>> users_;  ///< of the root of each library
  std::vector<std::int64_t> gone_;                                 ///< by vertex
  std::priority_queue<std::pair<std::int64_t, std::uint32_t>,
                      std::vector<std::pair<std::int64_t, std::uint32_t>>, std::greater<>>
      open_;
};

/// The resources that actions use up and none creates, with how many there are, but for those of the robot.
std::map<std::string, std::int64_t> used_up_only(const Mission& mission) {
  std::map<std::string, std::int64_t> counts;
  for (const Action& action : mission.actions) {
    for (const ResourceUse& use : action.resources) {
      const bool removes =
          use.operation == ResourceOperation::Consume || use.operation == ResourceOperation::Delete;
      if (removes && placeholders(use.resource).empty()) counts.try_emplace(use.resource, 1);
    }
  }
  for (const Resource& resource : mission.resources) {
    if (resource.of_robot)
      counts.erase(resource.name);
    else if (const auto found = counts.find(resource.name); found != counts.end())
      found->second = resource.count;
  }
  for (const Action& action : mission.actions) {
    for (const ResourceUse& use : action.resources) {
      if (use.operation != ResourceOperation::Create) continue;
      const std::string pattern = resource_pattern(use.resource);
      std::erase_if(counts, [&](const auto& entry) { return matches_glob(pattern, entry.first); });
    }
  }
  return counts;
}

}  // namespace

void check_units(const MissionIndex& index, Diagnostics& diagnostics) {
  const Mission& mission = index.mission();
  const auto counts = used_up_only(mission);
  if (counts.empty()) return;
  UsedUp used_up(index);
  for (const auto& [resource, count] : counts) {
    used_up.find(resource, count);
    for (StateIndex i = 0; i < mission.states.size(); ++i) {
      const Action* action = is_leaf(mission.states[i].kind) ? index.action_of(i) : nullptr;
      const auto gone = action == nullptr ? std::nullopt : used_up.gone_before(i);
      const std::int64_t need = gone ? needed(*action, resource) : 0;
      if (need == 0 || *gone == 0 || need <= count - *gone) continue;
      const std::int64_t left = std::max<std::int64_t>(0, count - *gone);
      diagnostics.warning("runs-short",
                          state_text(mission, i) + " always aborts: it needs " + std::to_string(need) +
                              " of the resource " + quote(resource) + ", of which at most " +
                              std::to_string(left) + (left == 1 ? " is" : " are") + " left when it begins",
                          mission.states[i].where);
    }
  }
}

}  // namespace segue::mission::detail

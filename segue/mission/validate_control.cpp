// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/checks.hpp>

#include <algorithm>
#include <unordered_map>

namespace segue::mission::detail {
namespace {

bool has_outcome(const std::vector<std::string>& outcomes, std::string_view name) {
  return name == kAbortedName || name == kPreemptedName ||
         std::ranges::find(outcomes, name) != outcomes.end();
}

class ControlCheck {
 public:
  ControlCheck(const MissionIndex& index, Diagnostics& diagnostics)
      : index_(index), mission_(index.mission()), diagnostics_(diagnostics) {}

  void run() {
    for (StateIndex i = 0; i < mission_.states.size(); ++i)
      check(i);
    check_recursion();
  }

 private:
  void error(std::string code, std::string message, const Place& where) {
    diagnostics_.error(std::move(code), std::move(message), where);
  }

  void check(StateIndex i) {
    const State& state = mission_.states[i];
    if (is_container(state.kind)) {
      check_container(i);
    } else if (state.kind == StateKind::Library) {
      if (index_.library(state.library) == nullptr) {
        error("missing-library",
              told(mission_, i) + ": there is no library " + quote(state.library) +
                  ", neither under 'libraries' nor as " + quote(state.library + ".yaml") +
                  " in the file's folder or the folders of libraries",
              state.where);
      }
    } else {
      check_action(i);
    }
    if (state.kind == StateKind::Decider &&
        (state.parent == kNoState || mission_.states[state.parent].kind != StateKind::Barrier)) {
      error("misplaced-decider", told(mission_, i) + ": only a barrier has a decider", state.where);
    }
    if (state.parent == kNoState) {
      check_ignored(i, "nothing is outside of it");
    } else {
      check_transitions(i);
    }
  }

  void check_action(StateIndex i) {
    const State& state = mission_.states[i];
    const Action* action = index_.action(state.action);
    if (action == nullptr) {
      error("unknown-action",
            told(mission_, i) + ": there is no action " + quote(state.action.str()) +
                did_you_mean(state.action.str(), action_names()),
            state.where);
    } else if (state.kind != StateKind::Decider && std::holds_alternative<Decision>(action->run)) {
      error("misplaced-decider",
            told(mission_, i) + ": action " + quote(state.action.str()) +
                " decides over a barrier; give the state 'kind: decider'",
            state.where);
    } else if (state.kind == StateKind::Decider) {
      check_rules(state, *action);
    }
  }

  void check_rules(const State& state, const Action& action) {
    const auto* decision = std::get_if<Decision>(&action.run);
    if (decision == nullptr || state.parent == kNoState) return;
    for (const DecisionRule& rule : decision->rules) {
      for (const auto& [id, outcome] : rule.when) {
        const StateIndex child = index_.child(state.parent, StateId(id));
        const auto interface = child == kNoState ? std::nullopt : index_.interface(child);
        if (child == kNoState) {
          error("unknown-state",
                "action " + quote(action.name.str()) + " decides by the state " + quote(id) +
                    ", which is not there",
                action.where);
        } else if (interface && !has_outcome(*interface->outcomes, outcome)) {
          error("unknown-outcome",
                "action " + quote(action.name.str()) + " decides by the outcome " + quote(outcome) + " of " +
                    told(mission_, child) + ", which lacks it",
                action.where);
        }
      }
    }
  }

  std::vector<std::string> action_names() const {
    std::vector<std::string> names;
    for (const Action& action : mission_.actions)
      names.push_back(action.name.str());
    return names;
  }

  void check_container(StateIndex i) {
    const State& state = mission_.states[i];
    std::unordered_map<std::string_view, StateIndex> ids;
    std::size_t deciders = 0;
    for (const StateIndex child : state.children) {
      if (mission_.states[child].kind == StateKind::Decider) ++deciders;
      if (ids.try_emplace(mission_.states[child].id.str(), child).second) continue;
      error("duplicate-state", told(mission_, child) + " is there twice in " + told(mission_, i),
            mission_.states[child].where);
    }
    if (state.kind == StateKind::Barrier && deciders != 1) {
      error("missing-decider",
            told(mission_, i) + ": a barrier has one state of the kind 'decider', not " +
                std::to_string(deciders),
            state.where);
    }
    if (state.kind != StateKind::Hierarchy && state.children.size() == deciders) {
      error("no-states", told(mission_, i) + " has no states", state.where);
    }
    if (state.kind == StateKind::Hierarchy) check_hierarchy(i);
  }

  void check_hierarchy(StateIndex i) {
    const State& state = mission_.states[i];
    if (!state.start) {
      error("missing-start", told(mission_, i) + " does not say under 'start' where to begin", state.where);
      return;
    }
    check_target(*state.start, i, told(mission_, i) + ": 'start'", state.where);
    const bool begins = state.start->leaves() || index_.child(i, state.start->state) != kNoState;
    if (!begins) return;
    const auto next = successors(index_, state);
    const auto seen = reached(index_, state, next);
    for (std::size_t child = 0; child < seen.size(); ++child) {
      if (seen[child]) continue;
      const State& lost = mission_.states[state.children[child]];
      diagnostics_.warning("unreachable-state",
                           told(mission_, state.children[child]) +
                               " is never reached: neither 'start' nor a transition leads there",
                           lost.where);
    }
  }

  void check_target(const Target& target, StateIndex container, const std::string& what, const Place& where) {
    const State& around = mission_.states[container];
    if (!target.leaves()) {
      if (index_.child(container, target.state) != kNoState) return;
      std::vector<std::string> ids;
      for (const StateIndex child : around.children)
        ids.push_back(mission_.states[child].id.str());
      error("unknown-state",
            what + " leads to " + quote(target.state.str()) + ", but " + told(mission_, container) +
                " has no such state" + did_you_mean(target.state.str(), ids),
            where);
    } else if (!has_outcome(around.outcomes, target.outcome)) {
      error("unknown-outcome",
            what + " returns " + quote(target.outcome) + ", but " + told(mission_, container) +
                " has no such outcome" + did_you_mean(target.outcome, around.outcomes),
            where);
    }
  }

  void check_ignored(StateIndex i, const std::string& why) {
    const State& state = mission_.states[i];
    if (state.transitions.empty()) return;
    diagnostics_.warning("ignored-transition", told(mission_, i) + ": its transitions mean nothing: " + why,
                         state.transitions.front().where);
  }

  void check_transitions(StateIndex i) {
    const State& state = mission_.states[i];
    const State& around = mission_.states[state.parent];
    if (around.kind == StateKind::Barrier && state.kind != StateKind::Decider)
      return check_ignored(i, "the decider tells how a barrier ends");
    const auto interface = index_.interface(i);
    for (const Transition& transition : state.transitions) {
      const std::string what = told(mission_, i) + ": the transition from " + quote(transition.outcome);
      if (interface && !has_outcome(*interface->outcomes, transition.outcome)) {
        error("unknown-outcome",
              told(mission_, i) + " has no outcome " + quote(transition.outcome) +
                  did_you_mean(transition.outcome, *interface->outcomes),
              transition.where);
      }
      if (is_concurrency(around.kind) && !transition.to.leaves()) {
        error("bad-target",
              what + " must leave " + told(mission_, state.parent) +
                  ", as in 'return success': its states run side by side",
              transition.where);
        continue;
      }
      check_target(transition.to, state.parent, what, transition.where);
    }
    if (!interface) return;
    for (const std::string& outcome : *interface->outcomes) {
      if (std::ranges::find(state.transitions, outcome, &Transition::outcome) != state.transitions.end())
        continue;
      error("unconnected-outcome",
            told(mission_, i) + ": its outcome " + quote(outcome) +
                " leads nowhere; say under 'on' what follows",
            state.where);
    }
  }

  /// Libraries that use themselves, by taking away those that only use what has been taken away.
  void check_recursion() {
    std::unordered_map<std::string_view, std::size_t> open;  // uses of other libraries within
    std::unordered_map<std::string_view, std::vector<std::string_view>> users;
    const std::vector<std::string_view> homes = homes_of_states();
    for (const Library& library : mission_.libraries)
      open.emplace(library.name, 0);
    for (std::size_t i = 0; i < mission_.states.size(); ++i) {
      const State& state = mission_.states[i];
      if (state.kind != StateKind::Library || homes[i].empty() || !open.contains(state.library)) continue;
      ++open[homes[i]];
      users[state.library].push_back(homes[i]);
    }
    std::vector<std::string_view> closed;
    for (const auto& [name, uses] : open) {
      if (uses == 0) closed.push_back(name);
    }
    while (!closed.empty()) {
      const std::string_view name = closed.back();
      closed.pop_back();
      for (const std::string_view user : users[name]) {
        if (--open[user] == 0) closed.push_back(user);
      }
      open.erase(name);
    }
    for (const Library& library : mission_.libraries) {
      if (open.contains(library.name))
        error("library-recursion", "library " + quote(library.name) + " contains itself, or one that does",
              library.where);
    }
  }

  /// The library that each state stands in; empty: the mission itself.
  std::vector<std::string_view> homes_of_states() const {
    std::vector<std::string_view> homes(mission_.states.size());
    for (const Library& library : mission_.libraries)
      homes[library.root] = library.name;
    for (std::size_t i = 0; i < mission_.states.size(); ++i) {
      const StateIndex parent = mission_.states[i].parent;
      if (parent != kNoState) homes[i] = homes[parent];
    }
    return homes;
  }

  const MissionIndex& index_;
  const Mission& mission_;
  Diagnostics& diagnostics_;
};

}  // namespace

std::vector<std::vector<std::uint32_t>> successors(const MissionIndex& index, const State& hierarchy) {
  const Mission& mission = index.mission();
  std::vector<std::vector<std::uint32_t>> next(hierarchy.children.size());
  std::unordered_map<std::string_view, std::uint32_t> positions;
  for (std::uint32_t i = 0; i < hierarchy.children.size(); ++i)
    positions.try_emplace(mission.states[hierarchy.children[i]].id.str(), i);
  for (std::size_t i = 0; i < hierarchy.children.size(); ++i) {
    for (const Transition& transition : mission.states[hierarchy.children[i]].transitions) {
      const auto found = positions.find(transition.to.state.str());
      if (!transition.to.leaves() && found != positions.end()) next[i].push_back(found->second);
    }
  }
  return next;
}

std::vector<bool> reached(const MissionIndex& index, const State& hierarchy,
                          const std::vector<std::vector<std::uint32_t>>& successors) {
  std::vector<bool> seen(hierarchy.children.size(), false);
  if (!hierarchy.start || hierarchy.start->leaves()) return seen;
  std::vector<std::uint32_t> open;
  for (std::uint32_t i = 0; i < hierarchy.children.size(); ++i) {
    if (index.mission().states[hierarchy.children[i]].id == hierarchy.start->state) open.push_back(i);
  }
  for (const std::uint32_t first : open)
    seen[first] = true;
  while (!open.empty()) {
    const std::uint32_t here = open.back();
    open.pop_back();
    for (const std::uint32_t there : successors[here]) {
      if (!seen[there]) open.push_back(there);
      seen[there] = true;
    }
  }
  return seen;
}

void check_control(const MissionIndex& index, Diagnostics& diagnostics) {
  ControlCheck(index, diagnostics).run();
}

}  // namespace segue::mission::detail

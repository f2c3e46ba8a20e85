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
    for (const StateIndex i : index_.duplicates()) {
      error(
          "duplicate-state",
          state_text(mission_, i) + " is defined twice in " + state_text(mission_, mission_.states[i].parent),
          mission_.states[i].where);
    }
    check_recursion();
  }

 private:
  void error(std::string code, std::string message, const SourcePlace& where) {
    diagnostics_.error(std::move(code), std::move(message), where);
  }

  void check(StateIndex i) {
    const State& state = mission_.states[i];
    if (is_container(state.kind)) {
      check_container(i);
    } else if (state.kind == StateKind::Library) {
      if (index_.library(state.library) == nullptr) {
        error("missing-library",
              state_text(mission_, i) + ": there is no library " + quote(state.library) +
                  ", neither under 'libraries' nor as " + quote(state.library + ".yaml") +
                  " in the file's folder or the folders of libraries",
              state.where);
      }
    } else {
      check_action(i);
    }
    if (state.kind == StateKind::Decider &&
        (state.parent == kNoState || mission_.states[state.parent].kind != StateKind::Barrier)) {
      error("misplaced-decider", state_text(mission_, i) + ": only a barrier has a decider", state.where);
    }
    if (state.parent == kNoState) {
      check_ignored(i, "it has no parent");
    } else {
      check_transitions(i);
    }
  }

  void check_action(StateIndex i) {
    const State& state = mission_.states[i];
    const Action* action = index_.action_of(i);
    if (action == nullptr) {
      error("unknown-action",
            state_text(mission_, i) + ": there is no action " + quote(state.action.str()) +
                did_you_mean(state.action.str(), action_names()),
            state.where);
    } else if (state.kind != StateKind::Decider && std::holds_alternative<Decision>(action->run)) {
      error("misplaced-decider",
            state_text(mission_, i) + ": action " + quote(state.action.str()) +
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
                    ", which does not exist",
                action.where);
        } else if (interface && !has_outcome(*interface->outcomes, outcome)) {
          error("unknown-outcome",
                "action " + quote(action.name.str()) + " decides by the outcome " + quote(outcome) + " of " +
                    state_text(mission_, child) + ", which has no such outcome",
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
    const auto deciders = std::ranges::count_if(
        state.children, [&](StateIndex child) { return mission_.states[child].kind == StateKind::Decider; });
    if (state.kind == StateKind::Barrier && deciders != 1) {
      error("missing-decider",
            state_text(mission_, i) + ": a barrier has one state of the kind 'decider', not " +
                std::to_string(deciders),
            state.where);
    }
    if (state.kind != StateKind::Hierarchy && std::ssize(state.children) == deciders) {
      error("no-states", state_text(mission_, i) + " has no states", state.where);
    }
    if (state.kind == StateKind::Hierarchy) check_hierarchy(i);
  }

  void check_hierarchy(StateIndex i) {
    const State& state = mission_.states[i];
    if (!state.start) {
      error("missing-start", state_text(mission_, i) + " does not say under 'start' where to begin",
            state.where);
      return;
    }
    const StateIndex first = state.start->leaves() ? kNoState : index_.child(i, state.start->state);
    check_target(*state.start, first, i, state.where, [&] { return state_text(mission_, i) + ": 'start'"; });
    if (!state.start->leaves() && first == kNoState) return;
    const auto seen = reached(index_, i, Successors(index_, state));
    for (std::size_t child = 0; child < seen.size(); ++child) {
      if (seen[child]) continue;
      const State& lost = mission_.states[state.children[child]];
      diagnostics_.warning("unreachable-state",
                           state_text(mission_, state.children[child]) +
                               " is never reached: neither 'start' nor a transition leads there",
                           lost.where);
    }
  }

  /// `found`: the state that the target names; `what`: whose target it is.
  template <class What>
  void check_target(const Target& target, StateIndex found, StateIndex container, const SourcePlace& where,
                    What what) {
    const State& around = mission_.states[container];
    if (!target.leaves()) {
      if (found != kNoState) return;
      std::vector<std::string> ids;
      for (const StateIndex child : around.children)
        ids.push_back(mission_.states[child].id.str());
      error("unknown-state",
            what() + " leads to " + quote(target.state.str()) + ", but " + state_text(mission_, container) +
                " has no such state" + did_you_mean(target.state.str(), ids),
            where);
    } else if (!has_outcome(around.outcomes, target.outcome)) {
      error("unknown-outcome",
            what() + " returns " + quote(target.outcome) + ", but " + state_text(mission_, container) +
                " has no such outcome" + did_you_mean(target.outcome, around.outcomes),
            where);
    }
  }

  void check_ignored(StateIndex i, const std::string& why) {
    const State& state = mission_.states[i];
    if (state.transitions.empty()) return;
    diagnostics_.warning("ignored-transition",
                         state_text(mission_, i) + ": its transitions have no effect: " + why,
                         state.transitions.front().where);
  }

  void check_transitions(StateIndex i) {
    const State& state = mission_.states[i];
    const State& around = mission_.states[state.parent];
    if (around.kind == StateKind::Barrier && state.kind != StateKind::Decider)
      return check_ignored(i, "the decider determines the outcome of a barrier");
    const auto interface = index_.interface(i);
    for (std::size_t number = 0; number < state.transitions.size(); ++number) {
      const StateTransition& transition = state.transitions[number];
      const auto what = [&] {
        return state_text(mission_, i) + ": the transition from " + quote(transition.outcome);
      };
      if (interface && !has_outcome(*interface->outcomes, transition.outcome)) {
        error("unknown-outcome",
              state_text(mission_, i) + " has no outcome " + quote(transition.outcome) +
                  did_you_mean(transition.outcome, *interface->outcomes),
              transition.where);
      }
      if (is_concurrency(around.kind) && !transition.to.leaves()) {
        error("bad-target",
              what() + " must leave " + state_text(mission_, state.parent) +
                  ", as in 'return success': its states run concurrently",
              transition.where);
        continue;
      }
      check_target(transition.to, index_.target(i, number), state.parent, transition.where, what);
    }
    if (!interface) return;
    for (const std::string& outcome : *interface->outcomes) {
      if (std::ranges::find(state.transitions, outcome, &StateTransition::outcome) != state.transitions.end())
        continue;
      error("unconnected-outcome",
            state_text(mission_, i) + ": its outcome " + quote(outcome) +
                " has no transition; add one under 'on'",
            state.where);
    }
  }

  /// Reports recursive libraries: those left after repeatedly removing all that only use removed ones.
  void check_recursion() {
    std::unordered_map<std::string_view, std::size_t> open;  // how many uses of other libraries each contains
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

  /// The library that contains each state; empty: the mission itself.
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

Successors::Successors(const MissionIndex& index, const State& hierarchy) {
  first_.reserve(hierarchy.children.size() + 1);
  for (const StateIndex child : hierarchy.children) {
    first_.push_back(static_cast<std::uint32_t>(all_.size()));
    for (std::size_t i = 0; i < index.mission().states[child].transitions.size(); ++i) {
      const StateIndex next = index.target(child, i);
      if (next != kNoState) all_.push_back(index.position(next));
    }
  }
  first_.push_back(static_cast<std::uint32_t>(all_.size()));
}

std::vector<bool> reached(const MissionIndex& index, StateIndex hierarchy, const Successors& successors) {
  std::vector<bool> seen(successors.size(), false);
  const auto& start = index.mission().states[hierarchy].start;
  const StateIndex first = start && !start->leaves() ? index.child(hierarchy, start->state) : kNoState;
  if (first == kNoState) return seen;
  std::vector<std::uint32_t> open = {index.position(first)};
  seen[open.front()] = true;
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

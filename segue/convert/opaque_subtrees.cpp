// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/convert/conversion_fault.hpp>
#include <segue/convert/opaque_subtrees.hpp>
#include <segue/mission/world_values.hpp>

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace segue::convert {

using mission::Action;
using mission::kNoState;
using mission::NextStep;
using mission::StateIndex;
using mission::StateKind;
using Kind = OpaqueSubtreeReason::Kind;

namespace {

bool declares_footprint(const Action& action) {
  return !action.preconditions.empty() || !action.during.empty() || !action.effects.empty() ||
         !action.changes.empty() || !action.resources.empty();
}

/// A fact or resource that an action touches. The name may have placeholders.
struct Touched {
  std::string name;
  bool changes = false;
  std::optional<bool> makes{};  ///< of a fact that it changes
  std::optional<bool> needs{};  ///< of a fact that it relies on
};

/// Stands for each of them.
constexpr std::string_view kAllFacts = "fact {any}";

/// Whether both names may stand for the same.
bool may_be_same(const std::string& a, const std::string& b) {
  const auto fixed = [](const std::string& name) { return std::string_view(name).substr(0, name.find('{')); };
  const std::string_view one = fixed(a);
  const std::string_view other = fixed(b);
  const bool exact = one.size() == a.size() && other.size() == b.size();
  return exact ? a == b : one.starts_with(other) || other.starts_with(one);
}

/// Whether one of them would have to wait for the other. Effects that agree need not.
bool conflict(const Touched& a, const Touched& b) {
  const bool agree = a.makes && a.makes == b.makes;
  return (a.changes || b.changes) && !agree && may_be_same(a.name, b.name);
}

/// The same, but for who looks at all facts.
bool conflict_by_name(const Touched& a, const Touched& b) {
  return a.name != kAllFacts && b.name != kAllFacts && conflict(a, b);
}

/// Whether one of them takes away what the other relies on.
bool contradict(const Touched& a, const Touched& b) {
  const auto takes = [](const Touched& one, const Touched& from) {
    return one.makes && from.needs && *one.makes != *from.needs;
  };
  return (takes(a, b) || takes(b, a)) && may_be_same(a.name, b.name);
}

class Search {
 public:
  explicit Search(const mission::Program& program) : program_(program) {}

  /// States of libraries come after those that use them, so one round is not always enough.
  std::vector<OpaqueSubtreeReason> run() {
    const std::size_t count = program_.nodes().size();
    reasons_.assign(count, {});
    opaque_.assign(count, kNoState);
    for (bool changed = true; changed;) {
      changed = false;
      for (StateIndex i = static_cast<StateIndex>(count); i-- > 0;)
        changed = update(i) || changed;
    }
    return std::move(reasons_);
  }

 private:
  [[nodiscard]] const mission::CompiledState& node(StateIndex state) const { return program_.node(state); }
  [[nodiscard]] const Action& action(StateIndex state) const {
    return program_.mission().actions[node(state).action];
  }

  /// Whether something has changed.
  bool update(StateIndex state) {
    const StateIndex inside = opaque_within(state);
    const OpaqueSubtreeReason reason = reason_of(state, inside);
    StateIndex unknown = inside;
    if (mission::is_leaf(node(state).kind) ? is_opaque(action(state))
                                           : reason.kind != Kind::None && inside == kNoState)
      unknown = state;
    const bool changed =
        reason.kind != reasons_[state].kind || (unknown == kNoState) != (opaque_[state] == kNoState);
    reasons_[state] = reason;
    opaque_[state] = unknown;
    return changed;
  }

  [[nodiscard]] StateIndex opaque_within(StateIndex state) const {
    if (node(state).kind == StateKind::Library) return opaque_[node(state).library];
    for (const StateIndex child : node(state).children) {
      if (child != node(state).decider && opaque_[child] != kNoState) return opaque_[child];
    }
    return kNoState;
  }

  /// `opaque`: the state in it that may touch anything, if there is one.
  [[nodiscard]] OpaqueSubtreeReason reason_of(StateIndex state, StateIndex opaque) const {
    if (program_.state(state).routine) return {Kind::Routine, state};
    const mission::CompiledState& entry = node(state);
    if (entry.kind == StateKind::Hierarchy) {
      const auto handler = std::ranges::find_if(entry.children, [&](StateIndex child) {
        return child != entry.decider && node(child).next[0].kind != NextStep::Kind::Nowhere;
      });
      if (handler != entry.children.end()) return {Kind::HandlesPreemption, *handler};
    }
    const bool beside = entry.children.size() > (entry.decider == kNoState ? 1U : 2U);
    if (mission::is_concurrency(entry.kind) && beside && opaque != kNoState)
      return {reads_world(opaque) ? Kind::ReadsWorldBeside : Kind::OpaqueBeside, opaque};
    if (entry.kind == StateKind::Preemptive) {
      const StateIndex child = unfinished_source(state);
      if (child != kNoState) return {Kind::UsesUnfinished, child};
      const StateIndex declaring = declaring_container(state);
      if (declaring != kNoState) return {Kind::DeclaresInRace, declaring};
    }
    if (mission::is_concurrency(entry.kind) && beside) {
      if (races(state)) return touching_the_same(state);
      const StateIndex child = first_beside(state, contradict);
      if (child != kNoState && !planted(ConversionFault::NeedsContradicted))
        return {Kind::ContradictedBeside, child};
    }
    return {};
  }

  [[nodiscard]] bool reads_world(StateIndex state) const {
    return mission::is_leaf(node(state).kind) && action(state).reads_world;
  }

  /// The first state in the preemptive container that has states itself and whose outputs are used: it could
  /// be preempted in the middle.
  [[nodiscard]] StateIndex unfinished_source(StateIndex race) const {
    const mission::CompiledState& container = node(race);
    const auto found = std::ranges::find_if(container.children, [&](StateIndex child) {
      const mission::CompiledState& state = node(child);
      if (mission::is_leaf(state.kind)) return false;
      const std::uint32_t last = state.first_output + static_cast<std::uint32_t>(state.outputs.size());
      const auto own = [&](std::uint32_t slot) { return slot >= state.first_output && slot < last; };
      return !state.into_variables.empty() || std::ranges::any_of(container.outputs, [&](const auto& output) {
        return std::ranges::any_of(output.slots, own);
      });
    });
    return found == container.children.end() ? kNoState : *found;
  }

  /// The state or one in it that is a container and declares something: it would have to be undone in the
  /// middle.
  [[nodiscard]] StateIndex declaring_container(StateIndex state) const {
    const mission::CompiledState& entry = node(state);
    if (entry.required != nullptr) return state;
    if (entry.kind == StateKind::Library) return declaring_container(entry.library);
    for (const StateIndex child : entry.children) {
      if (const StateIndex found = declaring_container(child); found != kNoState) return found;
    }
    return kNoState;
  }

  /// Whether it is a preemptive container, or there is one in it.
  [[nodiscard]] bool races(StateIndex state) const {
    const mission::CompiledState& entry = node(state);
    if (entry.kind == StateKind::Library) return races(entry.library);
    return entry.kind == StateKind::Preemptive ||
           std::ranges::any_of(entry.children, [this](StateIndex child) { return races(child); });
  }

  /// A state in the container that would have to wait for another one in it, since both touch the same. Such
  /// a wait only costs time, unless it decides which state of a preemptive container ends first.
  [[nodiscard]] OpaqueSubtreeReason touching_the_same(StateIndex container) const {
    if (planted(ConversionFault::RacesConflict)) return {};
    const StateIndex child = first_beside(container, conflict);
    if (child == kNoState) return {};
    if (const StateIndex by_name = first_beside(container, conflict_by_name); by_name != kNoState)
      return {Kind::ConflictBeside, by_name};
    return {Kind::ReadsWorldBeside, first_reader(container)};
  }

  /// The first state in the container that looks at all facts.
  [[nodiscard]] StateIndex first_reader(StateIndex container) const {
    const auto looks = [&](StateIndex child) {
      std::vector<Touched> own;
      if (child != node(container).decider) collect(child, own);
      return std::ranges::find(own, kAllFacts, &Touched::name) != own.end();
    };
    const auto found = std::ranges::find_if(node(container).children, looks);
    return found == node(container).children.end() ? kNoState : *found;
  }

  /// The first state in the container that touches something for which, together with something that a state
  /// before it touches, `stand` is true.
  [[nodiscard]] StateIndex first_beside(StateIndex container,
                                        bool (*stand)(const Touched& a, const Touched& b)) const {
    std::vector<Touched> before;
    for (const StateIndex child : node(container).children) {
      if (child == node(container).decider) continue;
      std::vector<Touched> own;
      collect(child, own);
      for (const Touched& touched : own) {
        if (std::ranges::any_of(before, [&](const Touched& other) { return stand(touched, other); }))
          return child;
      }
      before.insert(before.end(), own.begin(), own.end());
    }
    return kNoState;
  }

  /// Adds what the actions in the state touch.
  void collect(StateIndex state, std::vector<Touched>& touched) const {
    const mission::CompiledState& entry = node(state);
    if (entry.kind == StateKind::Library) return collect(entry.library, touched);
    if (mission::is_leaf(entry.kind)) return collect(action(state), touched);
    if (entry.required != nullptr) collect(*entry.required, touched);
    for (const StateIndex child : entry.children)
      collect(child, touched);
  }

  void collect(const Action& action, std::vector<Touched>& touched) const {
    for (const auto* facts : {&action.preconditions, &action.during}) {
      for (const mission::Fact& fact : *facts)
        touched.push_back({"fact " + to_string(fact), false, {}, fact.positive});
    }
    for (const mission::Fact& fact : action.effects)
      touched.push_back({"fact " + to_string(fact), true, fact.positive});
    for (const mission::ResourceUse& use : action.resources) {
      const bool only_looks = use.operation == mission::ResourceOperation::Exists && !varies(use.resource);
      touched.push_back({"resource " + use.resource, !only_looks});
    }
    for (const std::string& name : mission::values_touched(action)) {
      const auto changed = mission::values_changed(action);
      touched.push_back({"value " + name, std::ranges::binary_search(changed, name)});
    }
    if (action.reads_world) touched.push_back({std::string(kAllFacts), false});
  }

  /// Whether units of it are created or removed: then all that use it do so in program order.
  [[nodiscard]] bool varies(const std::string& name) const {
    return std::ranges::any_of(program_.mission().actions, [&](const Action& action) {
      return std::ranges::any_of(action.resources, [&](const mission::ResourceUse& use) {
        const bool changes = use.operation != mission::ResourceOperation::Exists &&
                             use.operation != mission::ResourceOperation::Block;
        return changes && may_be_same(use.resource, name);
      });
    });
  }

  const mission::Program& program_;
  std::vector<OpaqueSubtreeReason> reasons_;  ///< by state
  std::vector<StateIndex> opaque_;            ///< by state: the state in it that may touch anything
};

}  // namespace

/// A sensing action without declared preconditions may rely on any fact, and so does one that says so.
bool is_opaque(const Action& action) {
  return action.action_class() != ActionClass::Pure && (!declares_footprint(action) || action.reads_world) &&
         !planted(ConversionFault::NothingIsOpaque);
}

std::string text_of(const OpaqueSubtreeReason& reason, const mission::Program& program) {
  const std::string id = reason.state == kNoState ? "" : program.state(reason.state).id.str();
  switch (reason.kind) {
    case Kind::Routine:
      return "since it is declared a routine";
    case Kind::UsesUnfinished:
      return "since it uses outputs of " + id + ", which may be preempted in the middle";
    case Kind::HandlesPreemption:
      return "since a preemption of " + id + " is handled in it";
    case Kind::OpaqueBeside:
      return "since " + id + " in it, concurrent with others, may touch anything";
    case Kind::ReadsWorldBeside:
      return "since " + id + " in it, concurrent with others, reads the whole world";
    case Kind::ConflictBeside:
      return "since " + id +
             " in it touches what another state touches, which must not decide which one ends first";
    case Kind::ContradictedBeside:
      return "since " + id + " in it and a state beside it need and change a fact, one against the other";
    case Kind::DeclaresInRace:
      return "since " + id + " declares preconditions or resources, and may be preempted";
    case Kind::None:
      break;
  }
  return {};
}

std::vector<OpaqueSubtreeReason> find_opaque_subtrees(const mission::Program& program) {
  return Search(program).run();
}

}  // namespace segue::convert

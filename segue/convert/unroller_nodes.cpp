// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/convert/conversion_fault.hpp>
#include <segue/convert/unroller.hpp>
#include <segue/mission/footprint.hpp>
#include <segue/mission/outcome_likelihoods.hpp>
#include <segue/mission/units.hpp>

#include <algorithm>
#include <cassert>

namespace segue::convert {

using mission::Action;
using mission::kNoState;
using mission::NextStep;
using mission::Outcome;
using mission::StateIndex;
using mission::StateKind;
using task_network::Claim;
using task_network::NodeId;
using task_network::NodeSpec;
using task_network::OutcomeId;
using type::Value;

namespace {

Duration expected_duration(const Action& action) {
  if (action.expected_duration) return *action.expected_duration;
  const auto* simulated = std::get_if<mission::Simulated>(&action.run);
  return simulated == nullptr ? Duration::zero() : simulated->duration;
}

/// Whether it may use global and persistent variables: its code may, and so do outputs with such a default.
bool uses_variables(const Action& action) {
  return std::holds_alternative<mission::Callback>(action.run) ||
         std::holds_alternative<mission::Script>(action.run) ||
         std::ranges::any_of(action.outputs, [](const mission::Port& output) {
           return output.value.is_string() && output.value.as_string().starts_with('$');
         });
}

}  // namespace

/// Resources of which units are created or removed. All their users take units in program order, including
/// those that are planned before the first node that creates or removes some.
void Unroller::find_varying() {
  varying_ = mission::varying_resources(plan_.program().mission());
  blocked_within_ = mission::resources_blocked_within(plan_.program().mission());
}

/// Whether the state, or one in it, is declared strict.
bool Unroller::strict_within(StateIndex state) const {
  if (plan_.program().state(state).strict) return true;
  switch (node(state).kind) {
    case StateKind::Execution:
    case StateKind::Decider:
      return action(state).strict;
    case StateKind::Library:
      return strict_within(node(state).library);
    case StateKind::Hierarchy:
    case StateKind::Barrier:
    case StateKind::Preemptive:
      break;
  }
  return std::ranges::any_of(node(state).children, [this](StateIndex child) { return strict_within(child); });
}

/// An empty specification that reuses the memory of the last.
NodeSpec& Unroller::new_spec() {
  NodeSpec fresh;
  const auto keep_room = [](auto& from, auto& to) {
    from.clear();
    to.swap(from);
  };
  keep_room(spec_.preconditions, fresh.preconditions);
  keep_room(spec_.effects, fresh.effects);
  keep_room(spec_.claims, fresh.claims);
  keep_room(spec_.inputs, fresh.inputs);
  keep_room(spec_.conditions, fresh.conditions);
  spec_ = std::move(fresh);
  return spec_;
}

/// A node that executes nothing and cannot fail; `spec_` is its specification.
PlannedNode Unroller::begin_structural(Role role, BranchEdge when) {
  NodeSpec& spec = new_spec();
  spec.kind = ActionClass::Pure;
  spec.cannot_fail = true;
  spec.structural = true;
  PlannedNode planned;
  planned.role = role;
  planned.when = when;
  return planned;
}

/// The node is named after its state, or else as given.
NodeId Unroller::append(NodeSpec& spec, PlannedNode node, std::string_view name) {
  auto& names = plan_.network_.names;
  const bool is_state = !node.path.empty();
  const std::uint32_t number = names.intern(is_state ? node.path : name);
  if (number >= copies_.size()) copies_.resize(std::max<std::size_t>(number + 1, 2 * copies_.size()));
  node.iteration = spec.iteration = copies_[number]++;
  if (is_state) node.path = names.name(number);
  node.branch = branch_.place;
  spec.parallel_branch = branch_.in_network;
  spec.conditions = paths_.conditions(node.when);
  const NodeId id = plan_.network_.append(spec, number);
  for (Track* track = racing_; track != nullptr; track = track->around)
    track->open.push_back(id);
  plan_.nodes_.push_back(std::move(node));
  return id;
}

/// Whether it is known what the action touches, which an outline does not wait for, and whether its turn has
/// come.
bool Unroller::is_ready(const StateEntry& entry) {
  return (scope_ == PlanScope::Outline || naming_values(entry).has_value()) && is_in_turn(entry);
}

/// Units that come and go are taken in program order, also beside each other.
bool Unroller::is_in_turn(const StateEntry& entry) {
  for (const Track* beside : before_) {
    if (!shared_.shared(beside->branch.place->child, entry.state)) continue;
    plan_.waits_for_ = "how " + plan_.program().state(beside->branch.place->child).id.str() +
                       " goes on, which uses the same units before " +
                       plan_.program().state(entry.state).id.str();
    return false;
  }
  return true;
}

/// The inputs that facts and resources refer to, by port; nothing if one is not known yet.
std::optional<std::vector<Value>> Unroller::naming_values(const StateEntry& entry) {
  const Action& what = *plan_.program().declared(entry.state);
  std::vector<Value> values(what.inputs.size());
  for (const std::size_t port : naming_inputs(entry.state)) {
    const std::string& name = what.inputs[port].name;
    auto value = value_of(entry.inputs[port]);
    if (!value) {
      plan_.waits_for_ = "the input " + name + " of " + plan_.program().state(entry.state).id.str() +
                         ", which tells what it touches";
      return std::nullopt;
    }
    values[port] = std::move(*value);
  }
  return values;
}

const std::vector<std::size_t>& Unroller::naming_inputs(StateIndex state) {
  const bool leaf = mission::is_leaf(node(state).kind);
  auto& known = leaf ? touches_[node(state).action].named_by : named_by_[state];
  if (!known) known = mission::naming_inputs(*plan_.program().declared(state));
  return *known;
}

/// Adds the facts and resources of the action; if a name cannot be formed, the action will not begin.
void Unroller::declare(const StateEntry& entry, NodeSpec& spec, PlannedNode& planned) {
  Touch& cached = touches_[node(entry.state).action];
  Touch special;
  Touch& touch = entry.around == nullptr ? cached : special;
  if (!touch.known) {
    if (scope_ == PlanScope::Outline && !naming_values(entry)) return declare_unknown(entry, spec);
    const auto needs = needs_of(entry);
    if (!needs) {
      planned.refused = needs.error().message;
      return;
    }
    look_up(*needs, touch);
    touch.known = naming_inputs(entry.state).empty();
  }
  spec.preconditions = touch.preconditions;
  spec.effects = touch.effects;
  spec.claims = touch.claims;
  planned.observed = touch.observed;
  if (entry.memberships != nullptr)
    spec.claims.insert(spec.claims.end(), entry.memberships->begin(), entry.memberships->end());
}

/// Declares a fact of the node's own instead of the facts that are not known yet, so that it changes
/// something but depends on nothing.
void Unroller::declare_unknown(const StateEntry& entry, NodeSpec& spec) {
  const std::string name = "unknown(" + std::to_string(plan_.network_.size()) + ")";
  const auto fact = plan_.network_.facts.intern_named(name);
  const Action& what = action(entry.state);
  if (fact && (!what.effects.empty() || !what.resources.empty())) spec.effects.push_back({*fact, true});
}

/// The needs of the state with the declarations around it; an error if a name cannot be formed. Requires that
/// the values that names consist of are known.
Result<mission::Needs> Unroller::needs_of(const StateEntry& entry) {
  const auto values = naming_values(entry);
  assert(values);
  return mission::needs(plan_.program().mission(), *plan_.program().declared(entry.state), *values,
                        entry.path, entry.around);
}

void Unroller::look_up(const mission::Needs& needs, Touch& touch) {
  const auto literals = [&](const std::vector<mission::GroundFact>& facts,
                            std::vector<task_network::Literal>& into) {
    into.clear();
    for (const mission::GroundFact& fact : facts) {
      if (const auto id = plan_.network_.facts.intern_named(fact.text)) into.push_back({*id, fact.holds});
    }
  };
  literals(needs.preconditions, touch.preconditions);
  if (!planted(ConversionFault::ForgetsEffects)) literals(needs.effects, touch.effects);
  touch.observed = needs.observed;
  touch.claims.clear();
  const auto varies = [&](const std::string& name) {
    return std::ranges::any_of(varying_, [&](const auto& pattern) { return matches_glob(pattern, name); });
  };
  for (const mission::UnitUse& use : needs.uses) {
    if (planted(ConversionFault::ForgetsResources)) break;
    const auto resource = plan_.network_.resources.intern(use.resource);
    task_network::ResourceRecord& known = plan_.network_.resources[resource];
    known.varies = known.varies || varies(use.resource);
    touch.claims.push_back(
        {resource, static_cast<task_network::ResourceOp>(use.operation), use.count, task_network::kNone});
  }
}

void Unroller::take_passed_on(const StateEntry& entry, NodeSpec& spec, PlannedNode& planned) {
  planned.passes_on = passed_on_.kind(entry.state);
  if (planned.passes_on == PassedOn::Nothing) return;
  planned.passed_on =
      connect(spec, passed_on_.last(entry.state, entry.when, paths_), output_of(planned.passes_on));
}

/// How the state ends if it ends as its action says; nothing where that says nothing.
std::optional<OutcomeId> Unroller::expected_end(StateIndex state) {
  if (!mission::is_leaf(node(state).kind)) return std::nullopt;
  const std::string& expected = action(state).expected_outcome;
  if (expected.empty() || expected == mission::kPreemptedName) return std::nullopt;
  return plan_.network_.outcome(expected);
}

/// The state's own outcomes, and then `aborted` and `preempted` as far as it may end so. A subtree ends well
/// as any action of which nothing is said.
std::shared_ptr<const BranchEnds> Unroller::branch_ends(const StateEntry& entry) {
  const mission::CompiledState& state = node(entry.state);
  std::shared_ptr<const BranchEnds> unknown;
  const bool leaf = mission::is_leaf(state.kind);
  auto& known = leaf ? touches_[state.action].ends.at(entry.aborts_handled ? 1 : 0) : unknown;
  if (known != nullptr) return known;
  auto ends = std::make_shared<BranchEnds>();
  for (const std::string& outcome : *state.outcomes)
    ends->outcomes.push_back(plan_.network_.outcome(outcome));
  if (entry.aborts_handled) ends->outcomes.push_back(task_network::kAborted);
  if (scope_ == PlanScope::EveryEnd) ends->outcomes.push_back(task_network::kPreempted);
  Action subtree;
  subtree.outcomes = *state.outcomes;
  ends->likelihoods =
      mission::outcome_likelihoods(leaf ? action(entry.state) : subtree, entry.aborts_handled);
  ends->likelihoods.resize(ends->outcomes.size());
  known = std::move(ends);
  return known;
}

StateEnd Unroller::ends_of(const StateEntry& entry, NodeId id, const NodeSpec& spec) {
  const mission::CompiledState& state = node(entry.state);
  StateEnd end;
  for (const mission::Port& port : *state.output_ports) {
    Symbol value;
    value.candidates.push_back({id, plan_.network_.names.intern(port.name), entry.when, {}});
    end.outputs.push_back(std::move(value));
  }
  const auto own = static_cast<Outcome>(state.outcomes->size());
  // A subtree may end well and tell what was handled last in it.
  const auto handled = plan_.network_.names.intern(kHandledErrorOutput);
  const auto told = [&](BranchEdge when) {
    return spec.opaque_subtree ? std::vector<Candidate>{{id, handled, when, {}}} : std::vector<Candidate>{};
  };
  if (!spec.branches) {
    end.exits.push_back({0, {entry.when, false, told(entry.when)}});
    return end;
  }
  const auto ends = branch_ends(entry);
  const auto branch = paths_.add(id, entry.when, ends, expected_end(entry.state));
  const auto ended = [&](Outcome i) {
    return BranchEdge{branch, ends->outcomes[static_cast<std::size_t>(i)]};
  };
  for (Outcome i = 0; i < own; ++i)
    end.exits.push_back({i, {ended(i), false, told(ended(i))}});
  if (scope_ == PlanScope::EveryEnd)
    end.exits.push_back({mission::kPreempted, {{branch, task_network::kPreempted}, false, {}}});
  if (!entry.aborts_handled) return end;
  const BranchEdge aborted{branch, task_network::kAborted};
  end.exits.push_back(
      {mission::kAborted, {aborted, true, {{id, plan_.network_.names.intern(kErrorOutput), aborted, {}}}}});
  return end;
}

/// For a decider: how its siblings end.
std::vector<BranchSource> Unroller::connect_branches(NodeSpec& spec, const StateEntry& decider,
                                                     const std::vector<StateEnd>& ends) {
  std::vector<BranchSource> sources;
  for (const StateIndex state : node(node(decider.state).parent).children) {
    if (state == decider.state) continue;
    BranchSource source;
    source.state = state;
    for (const Exit& exit : ends[sources.size()].exits) {
      const auto live = paths_.live(exit.arrival.when);
      if (!live) continue;
      BranchEnd end;
      end.outcome = exit.outcome;
      const std::string name =
          "branch" + std::to_string(sources.size()) + '.' + std::to_string(source.ends.size());
      end.error = connect(spec, {exit.arrival.errors, {}}, name + ".error");
      if (!paths_.implies(decider.when, *live)) {
        end.input = plan_.network_.names.intern(name);
        end.reached = live->outcome;
        spec.inputs.push_back({paths_.node(*live), plan_.network_.names.intern(kOutcomeOutput), end.input});
      }
      source.ends.push_back(std::move(end));
    }
    sources.push_back(std::move(source));
  }
  return sources;
}

StateEnd Unroller::add_action(const StateEntry& entry, const std::vector<StateEnd>* branches) {
  const Action& what = action(entry.state);
  NodeSpec& spec = new_spec();
  PlannedNode planned;
  planned.path = entry.path;
  planned.loops = entry.loops;
  planned.state = entry.state;
  planned.shown_as = shown_as(entry);
  spec.kind = what.action_class();
  spec.duration = expected_duration(what);
  spec.branches = what.outcomes.size() > 1 || entry.aborts_handled;
  spec.handles_abort = entry.aborts_handled;
  spec.opaque = is_opaque(what);
  spec.reads_world = what.reads_world;
  spec.reads_beside = uses_variables(what);
  spec.strict = (entry.strict || what.strict) && !planted(ConversionFault::ForgetsStrict);
  if (!what.outcomes.empty()) spec.expected = plan_.network_.outcome(what.foreseen_outcome());
  declare(entry, spec, planned);
  planned.when = entry.when;
  for (std::size_t i = 0; i < entry.inputs.size(); ++i)
    planned.inputs.push_back(connect(spec, input_of(entry, what, i), what.inputs[i].name));
  wait_for_changes(entry, what, spec);
  planned.error_before = connect(spec, {entry.errors, {}}, kErrorOutput);
  take_passed_on(entry, spec, planned);
  if (branches != nullptr) planned.branches = connect_branches(spec, entry, *branches);
  const NodeId id = append(spec, std::move(planned), plan_.network_.name);
  put_in(entry.container, id);
  passed_on_.write(entry.state, entry.when, id, plan_.network_.names, paths_);
  StateEnd end = ends_of(entry, id, spec);
  if (!what.changes.empty()) change_world(entry, what, id, end);
  return end;
}

StateEnd Unroller::add_subtree(const StateEntry& entry) {
  const mission::CompiledState& state = node(entry.state);
  NodeSpec& spec = new_spec();
  PlannedNode planned;
  planned.role = Role::OpaqueSubtree;
  planned.path = entry.path;
  planned.loops = entry.loops;
  planned.state = entry.state;
  planned.shown_as = shown_as(entry);
  planned.around = entry.around;
  if (entry.memberships != nullptr) spec.claims = *entry.memberships;
  spec.opaque_subtree = true;
  spec.opaque = true;
  spec.reads_world = true;
  spec.strict = entry.strict || strict_within(entry.state);
  spec.branches = state.outcomes->size() > 1 || entry.aborts_handled;
  spec.handles_abort = entry.aborts_handled;
  if (!state.outcomes->empty()) spec.expected = plan_.network_.outcome(state.outcomes->front());
  planned.when = entry.when;
  for (std::size_t i = 0; i < entry.inputs.size(); ++i)
    planned.inputs.push_back(connect(spec, entry.inputs[i], (*state.input_ports)[i].name));
  connect_subtree_to_world(entry, spec, planned);
  planned.error_before = connect(spec, {entry.errors, {}}, kErrorOutput);
  const NodeId id = append(spec, std::move(planned), plan_.network_.name);
  put_in(entry.container, id);
  change_world_by_subtree(entry, id);
  return ends_of(entry, id, spec);
}

}  // namespace segue::convert

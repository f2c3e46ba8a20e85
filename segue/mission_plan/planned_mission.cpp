// SPDX-License-Identifier: Apache-2.0
#include <segue/mission_plan/planned_mission.hpp>

#include <segue/base/text.hpp>
#include <segue/mission/footprint.hpp>
#include <segue/mission/mission_io.hpp>

#include <algorithm>
#include <set>
#include <utility>

namespace segue::mission {

using task_network::FactId;
using task_network::Literal;
using task_network::NodeId;
using type::Value;

namespace {

constexpr std::string_view kDone = "done";
constexpr std::string_view kFailed = "failed";

/// A name for a mission or a state: other characters of PDDL become '_'.
std::string identifier(std::string_view text) {
  std::string result;
  for (const char c : text) {
    const std::string with = result + c;
    result += is_identifier(with) && c != '.' ? c : '_';
  }
  return result.substr(0, 200);
}

class PlanConverter {
 public:
  PlanConverter(const PlanMapping& mapping, const pddl::PddlPlan& plan, Diagnostics& diagnostics)
      : mapping_(mapping), plan_(plan), diagnostics_(diagnostics) {}

  Mission convert(const std::filesystem::path& folder) {
    const Mission& library = mapping_.library;
    mission_.name = identifier(plan_.network.name.empty() ? mapping_.name : plan_.network.name);
    mission_.globals = library.globals;
    mission_.world_data = library.world_data;
    mission_.observed = library.observed;
    mission_.resources = library.resources;
    add_world();
    State root;
    root.id = StateId(mission_.name);
    root.kind = StateKind::Hierarchy;
    root.outcomes = {std::string(kDone)};
    mission_.add(kNoState, std::move(root));
    for (std::uint32_t i = 0; i < plan_.network.size(); ++i)
      add_step(NodeId{i});
    join_states();
    relocate_scripts(folder);
    return std::move(mission_);
  }

 private:
  void refuse(std::string code, std::string message) {
    diagnostics_.error(std::move(code), std::move(message), {mapping_.file, 0, 0});
  }

  /// The fact of the mission that a literal of the plan is, positive where it is to hold.
  std::optional<Fact> fact_of(const Literal& literal) {
    const std::string& text = plan_.network.facts.text(literal.fact);
    auto fact = parse_fact(text, "");
    if (!fact) {
      refuse("bad-fact",
             quote(text) + " is not a fact that missions can have: bind its predicate under 'facts'");
      return std::nullopt;
    }
    const BoundPredicate* const bound = mapping_.find_predicate(fact->predicate);
    if (bound == nullptr) {
      fact->positive = literal.value;
      return fact;
    }
    const auto& known = mapping_.domain.predicates;
    const auto predicate = std::ranges::find(known, bound->name, &pddl::DomainPredicate::name);
    Fact result = bound->fact;
    result.positive = bound->fact.positive == literal.value;
    for (std::string& argument : result.arguments) {
      for (std::size_t i = 0; i < predicate->parameters.size(); ++i)
        replace_all(argument, "{" + predicate->parameters[i].name + "}", fact->arguments[i]);
    }
    return result;
  }

  static void replace_all(std::string& text, std::string_view old, std::string_view with) {
    for (auto at = text.find(old); at != std::string::npos; at = text.find(old, at + with.size()))
      text.replace(at, old.size(), with);
  }

  /// All facts that the plan mentions: where a predicate is bound to a negated fact, also those that do not
  /// hold.
  void add_world() {
    std::set<std::string> seen;
    for (std::uint32_t i = 0; i < plan_.network.facts.size(); ++i) {
      auto fact = fact_of({FactId{i}, plan_.network.initial_world.holds(FactId{i})});
      if (fact && fact->positive && seen.insert(to_string(*fact)).second)
        mission_.world.push_back(std::move(*fact));
    }
  }

  void add_step(NodeId node) {
    const pddl::PlannedStep& step = plan_.steps[index(node)];
    const BoundAction* const bound = mapping_.find_action(step.action);
    if (bound == nullptr) {
      if (unbound_.insert(step.action).second)
        refuse("unbound-action",
               "the plan needs the action " + quote(step.action) + ", which nothing carries out");
      return;
    }
    State state;
    state.id = StateId(free_name(plan_.network.name_of(node)));
    state.description = plan_.network.name_of(node);
    Action action = bound->action;
    action.name = ActionName(state.id.str());
    state.action = action.name;
    const auto& actions = mapping_.domain.actions;
    const auto known = std::ranges::find(actions, step.action, &pddl::DomainAction::name);
    for (const PortValue& input : bound->inputs)
      state.input_values.push_back({input.port, value_for(input.value, *known, step), input.where});
    if (known->durative) action.expected_duration = plan_.network[node].duration;
    add_facts(action, node, step);
    mission_.actions.push_back(std::move(action));
    mission_.add(0, std::move(state));
  }

  std::string free_name(std::string_view label) {
    std::string name = identifier(label);
    for (int number = 2; !names_.insert(name).second; ++number)
      name = identifier(label) + "_" + std::to_string(number);
    return name;
  }

  Value value_for(const Value& given, const pddl::DomainAction& known, const pddl::PlannedStep& step) {
    std::vector<Value> values;
    for (const std::string& object : step.objects)
      values.push_back(value_of(object));
    return filled(given, [&](std::string_view name) -> const Value& {
      const auto parameter = std::ranges::find(known.parameters, name, &pddl::DomainParameter::name);
      return values[static_cast<std::size_t>(parameter - known.parameters.begin())];
    });
  }

  Value value_of(const std::string& object) {
    for (const ObjectValues& objects : mapping_.objects) {
      const std::string types[] = {objects.type};
      if (!plan_.network.facts.is_a(object, types)) continue;
      const auto found = std::ranges::find(objects.values, object, &PortValue::port);
      if (found != objects.values.end()) return found->value;
      if (valueless_.insert(object).second)
        diagnostics_.error("no-value",
                           "the object " + quote(object) +
                               " of the problem has no value, as others of type " + quote(objects.type) +
                               " have",
                           objects.where);
    }
    return object;
  }

  void add_facts(Action& action, NodeId node, const pddl::PlannedStep& step) {
    const auto add = [&](std::vector<Fact>& facts, const Literal& literal) {
      auto fact = fact_of(literal);
      if (fact && std::ranges::find(facts, *fact) == facts.end()) facts.push_back(std::move(*fact));
    };
    for (const task_network::Access& access : plan_.network.accesses(node)) {
      if (access.reads) add(action.preconditions, {access.fact, access.needed});
      if (access.writes) add(action.effects, {access.fact, access.value});
    }
    for (const Literal& literal : step.during) {
      const auto fact = fact_of(literal);
      if (fact && is_observed(mission_, to_string(*fact))) add(action.during, literal);
    }
    for (const task_network::Claim& claim : plan_.network.claims(node)) {
      ResourceUse use;
      use.resource = plan_.network.resources.name(claim.resource);
      action.resources.push_back(std::move(use));
    }
  }

  /// The expected outcome of each step leads to the next one.
  void join_states() {
    State& root = mission_.states[0];
    const auto target = [&](std::size_t child) {
      return child < root.children.size() ? Target{mission_.states[root.children[child]].id, {}}
                                          : Target{StateId(), std::string(kDone)};
    };
    root.start = target(0);
    bool may_fail = false;
    for (std::size_t i = 0; i < root.children.size(); ++i) {
      const Action& action = mission_.actions[i];
      for (const std::string& outcome : action.outcomes) {
        const bool expected = outcome == action.foreseen_outcome();
        may_fail = may_fail || !expected;
        mission_.states[root.children[i]].transitions.push_back(
            {outcome, expected ? target(i + 1) : Target{StateId(), std::string(kFailed)}, {}});
      }
    }
    if (may_fail) root.outcomes.emplace_back(kFailed);
  }

  void relocate_scripts(const std::filesystem::path& folder) {
    const auto relocate = [&](Script& script, const SourcePlace& where) {
      if (script.file.empty()) return;
      const auto file = script_file(mapping_.library, script, where);
      script.file = file.lexically_relative(std::filesystem::absolute(folder).lexically_normal()).string();
    };
    for (Action& action : mission_.actions) {
      if (auto* script = std::get_if<Script>(&action.run)) relocate(*script, action.where);
    }
    for (DeclaredData& data : mission_.world_data)
      relocate(data.functions, data.where);
  }

  const PlanMapping& mapping_;
  const pddl::PddlPlan& plan_;
  Diagnostics& diagnostics_;
  Mission mission_;
  std::set<std::string> names_ = {"inputs", "outputs", "variables"};  ///< of states; these mean ports
  std::set<std::string> unbound_;
  std::set<std::string> valueless_;
};

}  // namespace

std::optional<Mission> planned_mission(const PlanMapping& mapping, const pddl::PddlPlan& plan,
                                       const std::filesystem::path& folder, Diagnostics& diagnostics) {
  const std::size_t errors_before = diagnostics.error_count();
  Mission mission = PlanConverter(mapping, plan, diagnostics).convert(folder);
  if (diagnostics.error_count() > errors_before) return std::nullopt;
  return mission;
}

}  // namespace segue::mission

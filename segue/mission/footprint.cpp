// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/footprint.hpp>
#include <segue/mission/kept_units.hpp>
#include <segue/mission/mission_index.hpp>
#include <segue/type/json.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

namespace segue::mission {

using type::Value;

namespace {

/// The value as part of a name: 2.0 becomes 2, since both are the same value.
std::optional<std::string> name_part(const Value& value) {
  if (value.is_string()) return value.as_string();
  if (value.is_bool() || value.is_integer()) return type::describe(value);
  if (!value.is_number() || !std::isfinite(value.as_double())) return std::nullopt;
  constexpr double kExact = 9007199254740992.0;  // integers up to 2^53 are exact
  const double number = value.as_double();
  if (std::trunc(number) == number && std::abs(number) <= kExact)
    return std::to_string(static_cast<std::int64_t>(number));
  return type::describe(value);
}

std::string ground_text(const std::string& predicate, const std::vector<std::string>& arguments) {
  std::string text = predicate + '(';
  for (std::size_t i = 0; i < arguments.size(); ++i)
    text += (i == 0 ? "" : ",") + arguments[i];
  return text + ')';
}

/// Forms the names of one execution.
class Grounding {
 public:
  Grounding(const Mission& mission, const Action& action, std::span<const Value> inputs,
            std::string_view path)
      : mission_(mission), action_(action), inputs_(inputs), path_(path) {}

  Result<Footprint> run() {
    Footprint footprint;
    for (const Fact& fact : action_.during) {
      if (auto added = add_required(fact, footprint.during); !added) return added.error();
    }
    footprint.preconditions = footprint.during;
    for (const Fact& fact : action_.preconditions) {
      if (auto added = add_required(fact, footprint.preconditions); !added) return added.error();
    }
    for (const Fact& fact : action_.effects) {
      auto text = named(fact);
      if (!text) return text.error();
      const auto known = std::ranges::find(footprint.effects, *text, &GroundFact::text);
      if (known == footprint.effects.end())
        footprint.effects.push_back({std::move(*text), fact.positive});
      else
        known->holds = known->holds || fact.positive;
    }
    for (const ResourceUse& use : action_.resources) {
      auto text = filled(use.resource, "resource " + quote(use.resource));
      if (!text) return text.error();
      if (auto fits = check_parameters(use, *text); !fits) return fits.error();
      if (auto fits = check_kept(*text); !fits) return fits.error();
      footprint.resources.push_back(std::move(*text));
    }
    return footprint;
  }

 private:
  [[nodiscard]] std::string where() const {
    return path_.empty() ? "action " + quote(action_.name.str()) : std::string(path_);
  }

  Result<void> add_required(const Fact& fact, std::vector<GroundFact>& facts) {
    auto text = named(fact);
    if (!text) return text.error();
    const auto known = std::ranges::find(facts, *text, &GroundFact::text);
    if (known == facts.end()) {
      facts.push_back({std::move(*text), fact.positive});
    } else if (known->holds != fact.positive) {
      return fail(ErrorCode::InvalidArgument,
                  where() + ": its preconditions " + *text + " and !" + *text + " contradict each other");
    }
    return {};
  }

  Result<std::string> named(const Fact& fact) {
    std::vector<std::string> arguments;
    for (const std::string& argument : fact.arguments) {
      auto text = filled(argument, "fact " + quote(to_string(fact)));
      if (!text) return text.error();
      arguments.push_back(std::move(*text));
    }
    const auto problem = mission_.vocabulary.problem(fact.predicate, arguments);
    std::string text = ground_text(fact.predicate, arguments);
    if (problem) return fail(ErrorCode::InvalidArgument, where() + ": its fact " + text + " " + *problem);
    return text;
  }

  /// Every placeholder is replaced once; the text of a value is never taken for a placeholder.
  Result<std::string> filled(const std::string& text, const std::string& what) {
    std::string result;
    for (std::size_t i = 0; i < text.size();) {
      const auto close = text[i] == '{' ? text.find('}', i) : std::string::npos;
      if (close == std::string::npos) {
        result += text[i++];
        continue;
      }
      auto part = value_of(text.substr(i + 1, close - i - 1), what);
      if (!part) return part.error();
      result += *part;
      i = close + 1;
    }
    return result;
  }

  Result<std::string> value_of(const std::string& input, const std::string& what) {
    const Value none;
    const Value* given = this->input(input);
    const Value& value = given == nullptr ? none : *given;
    const auto part = name_part(value);
    if (part && is_fact_argument(*part)) return *part;
    return fail(ErrorCode::InvalidArgument, where() + ": its " + what + " cannot be formed: the input " +
                                                quote(input) + " is " + type::describe(value) +
                                                (part ? ", which cannot be part of a name" : ""));
  }

  [[nodiscard]] const Value* input(const std::string& name) const {
    const auto port = position(action_.inputs, name);
    return port && *port < inputs_.size() ? &inputs_[*port] : nullptr;
  }

  /// Checks that the resource of kept units is declared; otherwise it would exist once, like any other
  /// resource that is not declared.
  Result<void> check_kept(const std::string& name) {
    if (!is_kept_name(name) ||
        std::ranges::find(mission_.resources, name, &Resource::name) != mission_.resources.end())
      return {};
    return fail(ErrorCode::InvalidArgument, where() + ": there is no resource " + quote(name) +
                                                ": what is kept must be declared under 'resources'");
  }

  /// Checks that the resource has the parameters that the action requires.
  Result<void> check_parameters(const ResourceUse& use, const std::string& name) {
    if (use.parameters.as_map().empty()) return {};
    const auto resource = std::ranges::find(mission_.resources, name, &Resource::name);
    const Value none;
    for (const auto& [key, parameter] : use.parameters.as_map()) {
      const auto from = parameter_input(parameter);
      const Value* wanted = from ? input(*from) : &parameter;
      const Value* there = resource == mission_.resources.end() ? nullptr : resource->parameters.find(key);
      if (wanted != nullptr && there != nullptr && *wanted == *there) continue;
      return fail(ErrorCode::InvalidArgument,
                  where() + ": its resource " + quote(name) + " must have the parameter " + quote(key) +
                      " with " + type::describe(wanted == nullptr ? none : *wanted) + ", but " +
                      (there == nullptr ? "has none" : "it is " + type::describe(*there)));
    }
    return {};
  }

  const Mission& mission_;
  const Action& action_;
  std::span<const Value> inputs_;
  std::string_view path_;
};

}  // namespace

std::vector<std::size_t> naming_inputs(const Action& action) {
  std::vector<std::size_t> inputs;
  const auto add_input = [&](std::string_view name) {
    const auto port = position(action.inputs, name);
    if (port && std::ranges::find(inputs, *port) == inputs.end()) inputs.push_back(*port);
  };
  const auto add = [&](std::string_view text) {
    for (const std::string& name : placeholders(text))
      add_input(name);
  };
  for (const auto* facts : {&action.preconditions, &action.during, &action.effects}) {
    for (const Fact& fact : *facts) {
      for (const std::string& argument : fact.arguments)
        add(argument);
    }
  }
  for (const ResourceUse& use : action.resources) {
    add(use.resource);
    for (const auto& [key, parameter] : use.parameters.as_map()) {
      if (const auto name = parameter_input(parameter)) add_input(*name);
    }
  }
  return inputs;
}

Result<Footprint> footprint(const Mission& mission, const Action& action, std::span<const Value> inputs,
                            std::string_view path) {
  return Grounding(mission, action, inputs, path).run();
}

std::string precondition_error(const GroundFact& precondition) {
  return std::string("its precondition ") + (precondition.holds ? "" : "!") + precondition.text +
         " does not hold";
}

Result<GroundFact> ground(const Fact& fact) {
  const bool fits = is_identifier(fact.predicate) && std::ranges::all_of(fact.arguments, is_fact_argument);
  if (fits) return GroundFact{ground_text(fact.predicate, fact.arguments), fact.positive};
  return fail(ErrorCode::InvalidArgument,
              quote(to_string(fact)) + " is not a fact such as 'at(robot,table)'");
}

bool is_observed(const Mission& mission, std::string_view fact) {
  return std::ranges::any_of(mission.observed, [&](const ObservedFact& one) {
    return ground_text(one.fact.predicate, one.fact.arguments) == fact;
  });
}

Result<Fact> parse_initial_fact(std::string_view text) {
  auto fact = parse_fact(text, "!");
  if (fact && ground(*fact)) return std::move(*fact);
  return fail(ErrorCode::ParseError,
              quote(text) + " is not a fact; expected text like 'at(robot,table)' or '!held(cup)'");
}

}  // namespace segue::mission

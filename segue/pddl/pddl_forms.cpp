// SPDX-License-Identifier: Apache-2.0
#include <segue/pddl/pddl_forms.hpp>

#include <segue/base/text.hpp>

#include <algorithm>
#include <array>
#include <set>
#include <utility>

namespace segue::pddl::detail {

namespace {

bool is_number(std::string_view word) {
  return !word.empty() && word.find_first_not_of("0123456789.") == std::string_view::npos;
}

constexpr std::pair<std::string_view, std::string_view> kForms[] = {{"<", "a numeric condition"},
                                                                    {">", "a numeric condition"},
                                                                    {"<=", "a numeric condition"},
                                                                    {">=", "a numeric condition"},
                                                                    {"preference", "a preference"},
                                                                    {"or", "'or'"},
                                                                    {"imply", "'imply'"},
                                                                    {"exists", "'exists'"},
                                                                    {"oneof", "an effect by chance"},
                                                                    {"probabilistic", "an effect by chance"},
                                                                    {"always", "a constraint"},
                                                                    {"sometime", "a constraint"},
                                                                    {"within", "a constraint"},
                                                                    {"over", "a condition over time"}};

}  // namespace

std::string_view unsupported_form(const PddlTerm& term) {
  if (!term.is_list() || term.list.empty()) return {};
  const std::string& word = term.list.front().word;
  for (const auto& [form, name] : kForms) {
    if (word == form) return name;
  }
  const bool timed = word == "at" && term.list.size() == 3 && term.list[2].is_list() &&
                     (term.list[1].word == "start" || term.list[1].word == "end");
  if (timed) return "a condition or an effect at a time";
  const bool equation =
      word == "=" && std::ranges::any_of(term.list.begin() + 1, term.list.end(), [](const PddlTerm& side) {
        return side.is_list() || is_number(side.word);
      });
  return equation ? "a numeric condition" : std::string_view();
}

bool is_numeric_effect(const PddlTerm& term) {
  return std::ranges::any_of(std::array{"increase", "decrease", "assign", "scale-up", "scale-down"},
                             [&](const char* word) { return term.begins_with(word); });
}

bool is_timed_literal(const PddlTerm& term) {
  return term.begins_with("at") && term.list.size() == 3 && is_number(term.list[1].word) &&
         term.list[2].is_list();
}

void check_sections(const std::vector<PddlTerm>& definition, std::initializer_list<std::string_view> known,
                    std::initializer_list<std::string_view> repeated, Diagnostics& diagnostics) {
  std::set<std::string> seen;
  for (std::size_t i = 2; i < definition.size(); ++i) {
    const PddlTerm& section = definition[i];
    const std::string name =
        section.is_list() && !section.list.empty() ? section.list.front().word : section.word;
    if (std::ranges::find(known, name) == known.end()) {
      diagnostics.error("unsupported",
                        section.is_list() && name.starts_with(':')
                            ? name + " is not supported"
                            : "a section such as (:init ...) was expected here",
                        section.where);
    } else if (std::ranges::find(repeated, name) == repeated.end() && !seen.insert(name).second) {
      diagnostics.error("duplicate-section", "a second section " + name, section.where);
    }
  }
}

void check_name(const std::string& name, const SourceLocation& where, Diagnostics& diagnostics) {
  const auto fits = [](char c) {
    return c > ' ' && c < '\x7f' && std::string_view(",!\"'[]{}:#").find(c) == std::string_view::npos;
  };
  if (std::ranges::all_of(name, fits)) return;
  diagnostics.error("bad-name", quote(name) + " is not a name: letters, digits, '-' and '_'", where);
}

/// A predicate may have the name of a form.
bool PddlForms::refuse_unsupported(const PddlTerm& term) {
  const std::string_view form = unsupported_form(term);
  if (form.empty() || arities_.contains(term.list.front().word)) return false;
  diagnostics_.error("unsupported", std::string(form) + " is not supported", term.where);
  return true;
}

void PddlForms::check_arguments(const PddlTerm& atom, const Variables& variables) {
  for (std::size_t i = 1; i < atom.list.size(); ++i) {
    const PddlTerm& argument = atom.list[i];
    if (argument.is_list()) {
      diagnostics_.error("bad-fact", "an object or a variable was expected here", argument.where);
    } else if (argument.word.starts_with('?') &&
               std::ranges::find(variables, argument.word, &PddlTyped::name) == variables.end()) {
      diagnostics_.error("unbound-variable", "nothing gives " + quote(argument.word) + " a value",
                         argument.where);
    }
  }
}

void PddlForms::check_atom(const PddlTerm& atom, const Variables& variables) {
  if (!atom.is_list() || atom.list.empty() || atom.list.front().word.empty())
    return diagnostics_.error("bad-fact", "a fact is a list of a predicate and its arguments", atom.where);
  const std::string& name = atom.list.front().word;
  const auto known = arities_.find(name);
  if (known == arities_.end())
    return diagnostics_.error("unknown-predicate", "no predicate " + quote(name), atom.where);
  if (known->second != atom.list.size() - 1) {
    return diagnostics_.error("bad-fact",
                              quote(name) + " takes " + std::to_string(known->second) + " arguments, not " +
                                  std::to_string(atom.list.size() - 1),
                              atom.where);
  }
  check_arguments(atom, variables);
}

void PddlForms::check_condition(const PddlTerm& condition, const Variables& variables) {
  if (condition.is_list() && condition.list.empty()) return;
  if (refuse_unsupported(condition)) return;
  if (condition.begins_with("=")) return check_arguments(condition, variables);
  if (condition.begins_with("and")) {
    for (std::size_t i = 1; i < condition.list.size(); ++i)
      check_condition(condition.list[i], variables);
    return;
  }
  if (condition.begins_with("not") && condition.list.size() == 2) {
    const PddlTerm& inner = condition.list[1];
    if (!inner.begins_with("and") && !inner.begins_with("not")) return check_condition(inner, variables);
    return diagnostics_.error("unsupported", "'not' of anything but a fact is not supported",
                              condition.where);
  }
  if (condition.begins_with("forall") || condition.begins_with("when"))
    return diagnostics_.error("unsupported",
                              quote(condition.list.front().word) + " is not supported in conditions",
                              condition.where);
  check_atom(condition, variables);
}

void PddlForms::check_for_all(const PddlTerm& effect, Variables variables) {
  if (effect.list.size() != 3)
    return diagnostics_.error("bad-effect", "expected (forall (VARIABLES) EFFECT)", effect.where);
  for (PddlTyped& variable : read_typed_list(effect.list[1].list, 0, diagnostics_))
    variables.push_back(std::move(variable));
  check_effect(effect.list[2], variables);
}

void PddlForms::check_effect(const PddlTerm& effect, const Variables& variables) {
  if (effect.is_list() && effect.list.empty()) return;
  if (refuse_unsupported(effect)) return;
  if (effect.begins_with("and")) {
    for (std::size_t i = 1; i < effect.list.size(); ++i)
      check_effect(effect.list[i], variables);
    return;
  }
  if (is_numeric_effect(effect)) return;
  if (effect.begins_with("forall")) return check_for_all(effect, variables);
  if (effect.begins_with("when")) {
    if (effect.list.size() != 3)
      return diagnostics_.error("bad-effect", "expected (when CONDITION EFFECT)", effect.where);
    check_condition(effect.list[1], variables);
    return check_effect(effect.list[2], variables);
  }
  check_atom(effect.begins_with("not") && effect.list.size() == 2 ? effect.list[1] : effect, variables);
}

}  // namespace segue::pddl::detail

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/pddl/pddl_text.hpp>

#include <initializer_list>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace segue::pddl::detail {

/// The name of a form that PDDL has and Segue does not carry out: "numeric conditions" for ">=",
/// "preferences" and so on; empty: no such form.
std::string_view unsupported_form(const PddlTerm& term);

/// An effect on numbers, of which plans are free: costs decide nothing in a plan.
bool is_numeric_effect(const PddlTerm& term);

/// Whether a term is "(at 5 (p a))": a timed initial literal, and no fact of a predicate `at`.
bool is_timed_literal(const PddlTerm& term);

/// Refuses sections of a definition that are not in `known`, and second ones of those that may be there once:
/// all but `repeated`.
void check_sections(const std::vector<PddlTerm>& definition, std::initializer_list<std::string_view> known,
                    std::initializer_list<std::string_view> repeated, Diagnostics& diagnostics);

/// Refuses a name that a task network cannot have.
void check_name(const std::string& name, const SourceLocation& where, Diagnostics& diagnostics);

/// Checks conditions and effects of actions before any plan is read, so that each mistake and each form that
/// is not supported is reported once, where it stands.
class PddlForms {
 public:
  using Arities = std::map<std::string, std::size_t, std::less<>>;  ///< of the predicates
  using Variables = std::vector<PddlTyped>;

  PddlForms(const Arities& arities, Diagnostics& diagnostics)
      : arities_(arities), diagnostics_(diagnostics) {}
  void check_condition(const PddlTerm& condition, const Variables& variables);
  void check_effect(const PddlTerm& effect, const Variables& variables);

 private:
  bool refuse_unsupported(const PddlTerm& term);
  void check_atom(const PddlTerm& atom, const Variables& variables);
  void check_arguments(const PddlTerm& atom, const Variables& variables);
  void check_for_all(const PddlTerm& effect, Variables variables);

  const Arities& arities_;
  Diagnostics& diagnostics_;
};

}  // namespace segue::pddl::detail

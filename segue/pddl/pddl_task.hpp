// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/pddl/pddl.hpp>
#include <segue/pddl/pddl_durative.hpp>
#include <segue/pddl/pddl_forms.hpp>
#include <segue/pddl/pddl_plan.hpp>
#include <segue/pddl/pddl_text.hpp>
#include <segue/task_network/task_network.hpp>

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace segue::pddl::detail {

/// Reads a PDDL task into a network: the declarations of domain and problem, then the plan, which is
/// simulated step by step. Internal to read_pddl.
class PddlTask {
 public:
  PddlTask(PddlPlan& plan, Diagnostics& diagnostics)
      : plan_(plan), network_(plan.network), diagnostics_(diagnostics) {}
  void read_domain(const std::vector<PddlTerm>& terms);
  void read_problem(const std::vector<PddlTerm>& terms);
  /// The declarations of the domain that was read.
  [[nodiscard]] PddlDomain domain() const;

  /// An action without duration requires all at its start and changes all at its end.
  struct Action {
    std::vector<PddlTyped> parameters;
    PddlTimed condition;
    PddlTimed effect;
    std::optional<PddlTerm> duration;  ///< of a durative one
  };
  [[nodiscard]] const std::map<std::string, Action>& actions() const { return actions_; }
  [[nodiscard]] const std::vector<std::string>& objects() const { return objects_; }
  /// With types, facts, initial world and goal of the problem that was read.
  [[nodiscard]] const task_network::TaskNetwork& network() const { return network_; }
  /// Of functions at first: "distance a b".
  [[nodiscard]] const std::map<std::string, double>& values() const { return values_; }
  /// Requires a domain and a problem without errors. `steps` as of parse_plan().
  void read_plan(const std::vector<PddlStep>& steps);

 private:
  using Binding = std::map<std::string, std::string>;
  /// A step of the plan, with the world before it.
  struct Step {
    task_network::NodeSpec spec;
    PlannedStep planned;
    task_network::VersionedWorld before;
    SourceLocation where;
  };

  void error(std::string code, std::string message, const SourceLocation& where);
  void check_domain_name(const std::vector<PddlTerm>& sections);
  const std::vector<PddlTerm>* definition(const std::vector<PddlTerm>& terms, std::string_view kind);
  void read_types(const PddlTerm& section);
  void read_constants(const PddlTerm& section);
  void declare_constant(const PddlTyped& constant);
  void read_predicates(const PddlTerm& section);
  void read_action(const PddlTerm& section);
  void read_parts(Action& action, const PddlTerm& section);
  void check_action(const Action& action);
  void note_changed_functions(const PddlTerm& effect);
  void read_initial(const PddlTerm& section);
  void read_value(const PddlTerm& entry);
  std::optional<Step> step_of(const PddlStep& given, std::uint32_t number);
  void add_conditions(const Action& action, const Binding& binding, Step& step);
  void add_effects(const Action& action, const Binding& binding, Step& step);
  void simulate(const Step& step);
  Duration duration(const Action& action, const Binding& binding, const PddlStep& given);
  std::optional<double> value(const PddlTerm& function, const Binding& binding);
  void keep_apart(std::vector<Step>& steps);
  bool bind(const Action& action, const PddlTerm& term, Binding& binding);

  std::optional<task_network::FactId> ground(const PddlTerm& atom, const Binding& binding);
  std::string value_of(const PddlTerm& term, const Binding& binding);
  void collect(const PddlTerm& condition, const Binding& binding, bool positive,
               std::vector<task_network::Literal>& literals);
  using Effects = std::vector<task_network::Literal>;
  void add_effect(const PddlTerm& effect, const Binding& binding, Step& step, Effects& effects);
  void add_conditional(const PddlTerm& effect, const Binding& binding, Step& step, Effects& effects);
  void add_for_all(const PddlTerm& effect, const Binding& binding, Step& step, Effects& effects,
                   std::size_t variable = 0);
  void demand(Step& step, const task_network::Literal& literal);

  PddlPlan& plan_;
  task_network::TaskNetwork& network_;
  Diagnostics& diagnostics_;
  std::map<std::string, Action> actions_;
  std::vector<std::string> objects_;
  std::string domain_;
  PddlForms::Arities arities_;
  std::map<std::string, std::vector<PddlTyped>> predicates_;
  std::map<std::string, std::vector<std::string>> constants_;  ///< with their types
  std::map<std::string, double> values_;                       ///< of functions: "distance a b"
  std::set<std::string> changed_functions_;                    ///< by some action
  task_network::VersionedWorld world_;
};

}  // namespace segue::pddl::detail

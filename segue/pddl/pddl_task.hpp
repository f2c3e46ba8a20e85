// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/pddl/pddl_forms.hpp>
#include <segue/pddl/pddl_text.hpp>
#include <segue/task_network/task_network.hpp>

#include <map>
#include <string>
#include <unordered_map>
#include <vector>

namespace segue::pddl::detail {

/// Reads a PDDL task into a network: the declarations of domain and problem, then the plan, which is
/// simulated step by step. Internal to read_pddl.
class PddlTask {
 public:
  PddlTask(task_network::TaskNetwork& network, Diagnostics& diagnostics)
      : network_(network), diagnostics_(diagnostics) {}
  void read_domain(const std::vector<PddlTerm>& terms);
  void read_problem(const std::vector<PddlTerm>& terms);
  /// Requires a domain and a problem without errors. `steps` as of parse_plan().
  void read_plan(const std::vector<PddlTerm>& steps);

 private:
  using Binding = std::map<std::string, std::string>;
  struct Action {
    std::vector<PddlTyped> parameters;
    PddlTerm precondition;
    PddlTerm effect;
  };
  /// A step of the plan, with the world before it.
  struct Step {
    task_network::NodeSpec spec;
    task_network::VersionedWorld before;
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
  void read_initial(const PddlTerm& section);
  void read_step(const PddlTerm& term, std::uint32_t number);
  bool bind(const Action& action, const PddlTerm& term, Binding& binding);

  std::optional<task_network::FactId> ground(const PddlTerm& atom, const Binding& binding);
  std::string value_of(const PddlTerm& term, const Binding& binding);
  void collect(const PddlTerm& condition, const Binding& binding, bool positive,
               std::vector<task_network::Literal>& literals);
  void add_effect(const PddlTerm& effect, const Binding& binding, Step& step);
  void add_conditional(const PddlTerm& effect, const Binding& binding, Step& step);
  void add_for_all(const PddlTerm& effect, const Binding& binding, Step& step, std::size_t variable = 0);
  void demand(Step& step, const task_network::Literal& literal);

  task_network::TaskNetwork& network_;
  Diagnostics& diagnostics_;
  std::unordered_map<std::string, Action> actions_;
  std::vector<std::string> objects_;
  std::string domain_;
  PddlForms::Arities arities_;
  std::map<std::string, std::vector<std::string>> constants_;  ///< with their types
  task_network::VersionedWorld world_;
};

}  // namespace segue::pddl::detail

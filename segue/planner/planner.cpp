// SPDX-License-Identifier: Apache-2.0
#include <segue/planner/planner.hpp>

#include <segue/planner/ground_task.hpp>
#include <segue/planner/search.hpp>

#include <array>
#include <charconv>

namespace segue::planner {

namespace {

std::string number_text(double number) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), number).ptr;
  return {text.data(), end};
}

}  // namespace

Result<Plan> find_plan(const pddl::PddlText& domain, const pddl::PddlText& problem,
                       const PlannerOptions& options) {
  Diagnostics diagnostics;
  const auto domain_terms = pddl::detail::parse_pddl(domain.text, domain.file, diagnostics);
  const auto problem_terms = pddl::detail::parse_pddl(problem.text, problem.file, diagnostics);
  pddl::PddlPlan read;
  pddl::detail::PddlTask task(read, diagnostics);
  if (domain_terms && problem_terms) task.read_domain(*domain_terms);
  if (!diagnostics.has_errors()) task.read_problem(*problem_terms);
  if (diagnostics.has_errors()) return diagnostics.to_error();
  const detail::Limits limits{options.deadline, options.stop, options.memory};
  const auto ground = detail::ground(task, limits);
  if (!ground) return ground.error();
  const auto found = detail::search(*ground, limits);
  if (!found) return found.error();
  Plan plan;
  plan.states = found->states;
  for (const std::uint32_t each : found->operators) {
    plan.text += ground->operators[each].step + "\n";
    plan.cost += ground->operators[each].cost;
  }
  plan.text +=
      "; cost = " + number_text(plan.cost) + (ground->has_costs ? " (general cost)\n" : " (unit cost)\n");
  return plan;
}

}  // namespace segue::planner

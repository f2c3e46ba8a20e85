// SPDX-License-Identifier: Apache-2.0
#include <segue/pddl/pddl.hpp>

#include <segue/base/file.hpp>
#include <segue/pddl/pddl_plan.hpp>
#include <segue/pddl/pddl_task.hpp>

namespace segue::pddl {

std::optional<PddlPart> part_of(const PddlText& text, Diagnostics& diagnostics) {
  if (!detail::begins_with_definition(text.text)) return PddlPart::Plan;
  const auto terms = detail::parse_pddl(text.text, text.file, diagnostics);
  if (!terms) return std::nullopt;
  const bool defines =
      terms->size() == 1 && terms->front().begins_with("define") && terms->front().list.size() > 1;
  if (!defines) return PddlPart::Plan;
  return terms->front().list[1].begins_with("problem") ? PddlPart::Problem : PddlPart::Domain;
}

std::optional<PddlDomain> read_domain(const PddlText& text, Diagnostics& diagnostics) {
  const std::size_t before = diagnostics.error_count();
  const auto terms = detail::parse_pddl(text.text, text.file, diagnostics);
  if (!terms) return std::nullopt;
  PddlPlan plan;
  detail::PddlTask task(plan, diagnostics);
  task.read_domain(*terms);
  if (diagnostics.error_count() > before) return std::nullopt;
  return task.domain();
}

std::optional<PddlPlan> read_pddl(const PddlText& domain, const PddlText& problem, const PddlText& plan,
                                  Diagnostics& diagnostics) {
  const std::size_t before = diagnostics.error_count();
  const auto failed = [&] { return diagnostics.error_count() > before; };
  const auto domain_terms = detail::parse_pddl(domain.text, domain.file, diagnostics);
  const auto problem_terms = detail::parse_pddl(problem.text, problem.file, diagnostics);
  const auto steps = detail::parse_plan(plan.text, plan.file, diagnostics);
  if (!domain_terms || !problem_terms || !steps) return std::nullopt;
  std::optional<PddlPlan> read(std::in_place);
  detail::PddlTask task(*read, diagnostics);
  // A mistake in one text makes others look wrong.
  task.read_domain(*domain_terms);
  if (!failed()) task.read_problem(*problem_terms);
  if (!failed()) task.read_plan(*steps);
  if (failed()) return std::nullopt;
  return read;
}

std::optional<PddlPlan> load_pddl(const std::filesystem::path& domain, const std::filesystem::path& problem,
                                  const std::filesystem::path& plan, Diagnostics& diagnostics) {
  std::string texts[3];
  const std::filesystem::path* files[3] = {&domain, &problem, &plan};
  for (std::size_t i = 0; i < 3; ++i) {
    auto text = read_file(*files[i]);
    if (!text) {
      diagnostics.error("unreadable-file", text.error().message, {files[i]->string(), 0, 0});
      return std::nullopt;
    }
    texts[i] = std::move(*text);
  }
  return read_pddl({texts[0], domain.string()}, {texts[1], problem.string()}, {texts[2], plan.string()},
                   diagnostics);
}

}  // namespace segue::pddl

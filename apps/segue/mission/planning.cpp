// SPDX-License-Identifier: Apache-2.0
#include "planning.hpp"

#include <segue/base/clock.hpp>
#include <segue/base/input_file.hpp>
#include <segue/base/rounded_text.hpp>
#include <segue/base/text.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission_plan/planned_mission.hpp>
#include <segue/mission_robot/fact_observer.hpp>
#include <segue/model/files.hpp>
#include <segue/planner/planner.hpp>
#include <segue/planner/planner_process.hpp>

#include <fmt/core.h>

#include <array>
#include <utility>

#include "../output.hpp"

namespace segue::cli {

namespace {

/// A program with a slash is relative to the robot file.
std::string located(const std::string& program, const std::filesystem::path& folder) {
  if (program.find('/') == std::string::npos) return program;
  return std::filesystem::absolute(folder / program).lexically_normal().string();
}

}  // namespace

Result<PlanningText> read_planning_text(const std::string& file) {
  auto text = read_input_file(file);
  if (!text) return text.error();
  return PlanningText{std::move(*text), file};
}

PlanningText domain_of(const mission::PlanMapping& mapping) {
  return {mapping.domain_text, mapping.domain_file.string()};
}

std::optional<model::PlannerProgram> planner_of(const std::string& robot_file, Diagnostics& diagnostics) {
  if (robot_file.empty()) return std::nullopt;
  const auto robot = model::load_robot(robot_file, diagnostics);
  if (!robot || !robot->planner) return std::nullopt;
  model::PlannerProgram program = *robot->planner;
  program.command.front() = located(program.command.front(), robot->folder);
  return program;
}

Result<PlanningText> find_plan(const std::optional<model::PlannerProgram>& program,
                               const PlanningText& domain, const PlanningText& problem,
                               const std::stop_token& stop) {
  const TimePoint begin = RealClock::instance().now();
  PlanningText plan;
  if (program) {
    plan.from = "the plan of " + quote(program->command.front());
    auto text = planner::run_planner({program->command, program->timeout, program->memory}, domain.text,
                                     problem.text, stop);
    if (!text) return text.error();
    plan.text = std::move(*text);
  } else {
    plan.from = "the plan of the built-in planner";
    planner::PlannerOptions options;
    options.deadline = begin + model::PlannerProgram().timeout;
    options.stop = stop;
    auto found = planner::find_plan(domain.pddl(), problem.pddl(), options);
    if (!found) return found.error();
    plan.text = std::move(found->text);
  }
  print_note(fmt::format("{} took {}", plan.from, format_seconds(RealClock::instance().now() - begin)));
  return plan;
}

std::vector<pddl::GroundAtom> observe(const mission::PlanMapping& mapping,
                                      const std::shared_ptr<mission::CommandedRobot>& robot) {
  mission::FactObserver observer(robot, mapping.library, {});
  std::vector<pddl::GroundAtom> atoms;
  for (const mission::ObservedFact& each : mapping.library.observed) {
    const auto fact = mission::ground(each.fact);
    if (!fact) continue;
    // The first sample of a port is waited for.
    const std::array<mission::GroundFact, 1> asked = {*fact};
    (void)observer.first_false(asked);
    const auto holds = observer.observed(fact->text);
    if (!holds) {
      print_note(fmt::format("{} cannot be observed now: what is known of it counts", fact->text));
      continue;
    }
    if (auto atom = mission::observed_atom(mapping, each.fact, *holds)) atoms.push_back(std::move(*atom));
  }
  return atoms;
}

std::optional<mission::Mission> mission_of(const mission::PlanMapping& mapping, const pddl::PddlPlan& plan,
                                           const std::filesystem::path& file, Diagnostics& diagnostics) {
  const auto folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  const auto planned = mission::planned_mission(mapping, plan, folder, diagnostics);
  if (!planned) return std::nullopt;
  auto checked = mission::load_mission_text(mission::write_mission(*planned), file, {}, diagnostics);
  if (checked) print_diagnostics(diagnostics);
  return checked;
}

}  // namespace segue::cli

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/base/result.hpp>
#include <segue/mission/commanded_robot.hpp>
#include <segue/mission_plan/plan_mapping.hpp>
#include <segue/model/robot.hpp>
#include <segue/pddl/pddl.hpp>
#include <segue/pddl/pddl_problem.hpp>

#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

/// Plans for a robot, with its planner and its facts.
namespace segue::cli {

/// A text and the file, or the program, that it comes from.
struct PlanningText {
  std::string text;
  std::string from;
  [[nodiscard]] pddl::PddlText pddl() const { return {text, from}; }
};
/// Blocks on the file.
Result<PlanningText> read_planning_text(const std::string& file);
PlanningText domain_of(const mission::PlanMapping& mapping);

/// The planner that a robot file names, its program found from there; nothing: the built-in one. With errors
/// where the file has some. Blocks on files.
std::optional<model::PlannerProgram> planner_of(const std::string& robot_file, Diagnostics& diagnostics);

/// A plan of that planner, or of the built-in one. Says on standard error how long it took. Blocks; Cancelled
/// at the stop, else as of planner::run_planner() and planner::find_plan().
Result<PlanningText> find_plan(const std::optional<model::PlannerProgram>& program,
                               const PlanningText& domain, const PlanningText& problem,
                               const std::stop_token& stop);

/// The facts that the mapping observes, as the robot shows them now; a note on standard error for each that
/// cannot be observed. Blocks until the robot has answered.
std::vector<pddl::GroundAtom> observe(const mission::PlanMapping& mapping,
                                      const std::shared_ptr<mission::CommandedRobot>& robot);

/// The mission of a plan, whose file is to be that, with all checks; prints the warnings. Nothing, and
/// diagnostics, where there are errors.
std::optional<mission::Mission> mission_of(const mission::PlanMapping& mapping, const pddl::PddlPlan& plan,
                                           const std::filesystem::path& file, Diagnostics& diagnostics);

}  // namespace segue::cli

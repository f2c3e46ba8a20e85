// SPDX-License-Identifier: Apache-2.0
#include "mission_plan.hpp"

#include <segue/mission/mission_io.hpp>
#include <segue/remote_robot/served_robot.hpp>

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "../connection.hpp"
#include "../models.hpp"
#include "../output.hpp"
#include "../stop_signal.hpp"
#include "mission_pursuit.hpp"
#include "planning.hpp"
#include "run_files.hpp"

namespace segue::cli {

namespace {

using mission::PlanMapping;

struct MissionPlanOptions {
  std::string mapping;
  std::string problem;
  std::string plan;
  std::string robot_file;
  bool observe = false;
  bool run = false;
  std::size_t attempts = 5;
  std::string output;
};

Result<PlanningText> text_of_plan(const MissionPlanOptions& options, const PlanningText& domain,
                                  const PlanningText& problem,
                                  const std::optional<model::PlannerProgram>& planner) {
  if (!options.plan.empty()) return read_planning_text(options.plan);
  StopSignal signal;
  return find_plan(planner, domain, problem, signal.token());
}

/// `problem`: as the world was observed.
int plan_mission(const MissionPlanOptions& options, const PlanMapping& mapping, const PlanningText& problem,
                 const std::optional<model::PlannerProgram>& planner, const Context& context) {
  Diagnostics diagnostics;
  const PlanningText domain = domain_of(mapping);
  const auto text = text_of_plan(options, domain, problem, planner);
  if (!text) return failed(context, text.error());
  const auto plan = pddl::read_pddl(domain.pddl(), problem.pddl(), text->pddl(), diagnostics);
  if (!plan) return report_failure(context, diagnostics);
  const std::string file = options.output.empty() ? mapping.name + ".yaml" : options.output;
  const auto planned = mission_of(mapping, *plan, file, diagnostics);
  if (!planned) return report_failure(context, diagnostics);
  return write_or_print(context, options.output, mission::write_mission(*planned));
}

int plan_mission(const MissionPlanOptions& options, Context& context) {
  if (!options.output.empty()) {
    if (const auto fits = check_writable(options.output); !fits) return failed(context, fits.error());
  }
  Diagnostics diagnostics;
  const auto mapping = mission::load_mapping(options.mapping, diagnostics);
  const auto planner = planner_of(options.robot_file, diagnostics);
  if (diagnostics.has_errors()) return report_failure(context, diagnostics);
  print_diagnostics(diagnostics);
  auto problem = read_planning_text(options.problem);
  if (!problem) return failed(context, problem.error());
  if (options.run) {
    return with_robot(context, [&](control::RobotService& robot) {
      return pursue({*mapping, std::move(*problem), planner, options.attempts}, robot, context);
    });
  }
  if (!options.observe) return plan_mission(options, *mapping, *problem, planner, context);
  return with_robot(context, [&](control::RobotService& service) {
    const auto robot = std::make_shared<remote_robot::ServedRobot>(service, sender("mission plan"));
    auto text = pddl::problem_with(problem->pddl(), observe(*mapping, robot), diagnostics);
    if (!text) return report_failure(context, diagnostics);
    return plan_mission(options, *mapping, {std::move(*text), problem->from + ", as observed"}, planner,
                        context);
  });
}

}  // namespace

void add_mission_plan(Verb& mission, Context& context) {
  const auto options = std::make_shared<MissionPlanOptions>();
  Verb& verb = add_verb(
      mission, context, "plan", "plan with PDDL, or take a plan, and make a mission of it by a mapping file",
      "  segue mission plan mapping.yaml problem.pddl -o fetch.yaml     # with the built-in planner\n"
      "  segue mission plan mapping.yaml problem.pddl --robot-file robot.yaml --observe -o fetch.yaml\n"
      "  segue mission plan mapping.yaml problem.pddl --plan plan.txt -o fetch.yaml\n"
      "  segue mission run fetch.yaml\n"
      "  segue mission plan mapping.yaml problem.pddl --run     # and plan anew where something goes wrong",
      [options, &context] { return plan_mission(*options, context); });
  verb.option("MAPPING", options->mapping,
              "binds the actions, objects and facts of a PDDL domain to those of missions")
      .required();
  verb.option("PROBLEM", options->problem, "the PDDL problem: its objects, what holds at first, the goal")
      .required();
  const Option plan = verb.option("--plan FILE", options->plan, "a plan, as any planner writes it");
  verb.option("--robot-file FILE", options->robot_file,
              "the robot file, which names the planner to ask (default: the built-in one)")
      .excludes(plan);
  verb.flag(
      "--observe", options->observe,
      "facts that the mapping observes begin as the running robot shows them, whatever the problem says");
  const Option output = verb.option("-o,--output FILE", options->output,
                                    "write the mission to a file instead of standard output");
  const Option run = verb.flag("--run", options->run,
                               "run the mission on the robot, and plan anew from what it shows where that "
                               "does not end as planned, until the goal holds")
                         .excludes(plan)
                         .excludes(output);
  verb.option("--attempts N", options->attempts, "make at most so many plans (default 5)")
      .between(1, 1'000'000)
      .needs(run);
  add_robot_option(verb, context);
}

}  // namespace segue::cli

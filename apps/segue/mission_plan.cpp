// SPDX-License-Identifier: Apache-2.0
#include "mission_plan.hpp"

#include <segue/base/input_file.hpp>
#include <segue/base/rounded_text.hpp>
#include <segue/base/text.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission_plan/planned_mission.hpp>
#include <segue/mission_robot/fact_observer.hpp>
#include <segue/model/files.hpp>
#include <segue/planner/planner.hpp>
#include <segue/planner/planner_process.hpp>
#include <segue/remote_robot/served_robot.hpp>

#include <fmt/core.h>

#include <array>
#include <filesystem>
#include <memory>
#include <optional>

#include "connection.hpp"
#include "models.hpp"
#include "output.hpp"
#include "stop_signal.hpp"

namespace segue::cli {

namespace {

using mission::PlanMapping;

struct MissionPlanOptions {
  std::string mapping;
  std::string problem;
  std::string plan;
  std::string robot_file;
  bool observe = false;
  std::string output;
};

/// A text and the file, or the program, that it comes from.
struct Text {
  std::string text;
  std::string from;
  [[nodiscard]] pddl::PddlText pddl() const { return {text, from}; }
};

/// The facts that the mapping observes, as the robot shows it now.
std::vector<pddl::ObservedAtom> observe(const PlanMapping& mapping, control::RobotService& service) {
  const auto robot = std::make_shared<remote_robot::ServedRobot>(service, sender("mission plan"));
  mission::FactObserver observer(robot, mapping.library, {});
  std::vector<pddl::ObservedAtom> atoms;
  for (const mission::ObservedFact& each : mapping.library.observed) {
    const auto fact = mission::ground(each.fact);
    if (!fact) continue;
    // The first sample of a port is waited for.
    const std::array<mission::GroundFact, 1> asked = {*fact};
    (void)observer.first_false(asked);
    const auto holds = observer.observed(fact->text);
    if (!holds) {
      print_note(fmt::format("{} cannot be observed now: what the problem says counts", fact->text));
      continue;
    }
    if (auto atom = mission::observed_atom(mapping, each.fact, *holds)) atoms.push_back(std::move(*atom));
  }
  return atoms;
}

/// A program with a slash is relative to the robot file.
std::string located(const std::string& program, const std::filesystem::path& folder) {
  if (program.find('/') == std::string::npos) return program;
  return std::filesystem::absolute(folder / program).lexically_normal().string();
}

/// The plan of the robot's planner, or of the built-in one.
Result<Text> find_plan(const std::optional<model::PlannerProgram>& program, const Text& domain,
                       const Text& problem) {
  StopSignal signal;
  const TimePoint begin = RealClock::instance().now();
  Text plan;
  if (program) {
    plan.from = "the plan of " + quote(program->command.front());
    auto text = planner::run_planner({program->command, program->timeout, program->memory}, domain.text,
                                     problem.text, signal.token());
    if (!text) return text.error();
    plan.text = std::move(*text);
  } else {
    plan.from = "the plan of the built-in planner";
    planner::PlannerOptions options;
    options.deadline = begin + model::PlannerProgram().timeout;
    options.stop = signal.token();
    auto found = planner::find_plan(domain.pddl(), problem.pddl(), options);
    if (!found) return found.error();
    plan.text = std::move(found->text);
  }
  print_note(fmt::format("{} took {}", plan.from, format_seconds(RealClock::instance().now() - begin)));
  return plan;
}

Result<Text> read(const std::string& file) {
  auto text = read_input_file(file);
  if (!text) return text.error();
  return Text{std::move(*text), file};
}

int write_planned(const MissionPlanOptions& options, const PlanMapping& mapping, const pddl::PddlPlan& plan,
                  const Context& context) {
  Diagnostics diagnostics;
  const std::filesystem::path file = options.output.empty() ? mapping.name + ".yaml" : options.output;
  const auto folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  const auto planned = mission::planned_mission(mapping, plan, folder, diagnostics);
  if (!planned) return report_failure(context, diagnostics);
  const std::string text = mission::write_mission(*planned);
  (void)mission::load_mission_text(text, file, {}, diagnostics);
  if (diagnostics.has_errors()) return report_failure(context, diagnostics);
  print_diagnostics(diagnostics);
  return write_or_print(context, options.output, text);
}

/// `problem`: as the world was observed.
int plan_mission(const MissionPlanOptions& options, const PlanMapping& mapping, const Text& problem,
                 const Context& context) {
  Diagnostics diagnostics;
  std::optional<model::PlannerProgram> program;
  if (!options.robot_file.empty()) {
    const auto robot = model::load_robot(options.robot_file, diagnostics);
    if (!robot) return report_failure(context, diagnostics);
    program = robot->planner;
    if (program) program->command.front() = located(program->command.front(), robot->folder);
  }
  const Text domain{mapping.domain_text, mapping.domain_file.string()};
  const auto plan = options.plan.empty() ? find_plan(program, domain, problem) : read(options.plan);
  if (!plan) return failed(context, plan.error());
  const auto read_plan = pddl::read_pddl(domain.pddl(), problem.pddl(), plan->pddl(), diagnostics);
  if (!read_plan) return report_failure(context, diagnostics);
  return write_planned(options, mapping, *read_plan, context);
}

int plan_mission(const MissionPlanOptions& options, Context& context) {
  if (!options.output.empty()) {
    if (const auto fits = check_writable(options.output); !fits) return failed(context, fits.error());
  }
  Diagnostics diagnostics;
  const auto mapping = mission::load_mapping(options.mapping, diagnostics);
  if (!mapping) return report_failure(context, diagnostics);
  print_diagnostics(diagnostics);
  auto problem = read(options.problem);
  if (!problem) return failed(context, problem.error());
  if (!options.observe) return plan_mission(options, *mapping, *problem, context);
  return with_robot(context, [&](control::RobotService& robot) {
    auto text = pddl::problem_with(problem->pddl(), observe(*mapping, robot), diagnostics);
    if (!text) return report_failure(context, diagnostics);
    return plan_mission(options, *mapping, {std::move(*text), problem->from + ", as observed"}, context);
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
      "  segue mission run fetch.yaml",
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
  verb.option("-o,--output FILE", options->output, "write the mission to a file instead of standard output");
  add_robot_option(verb, context);
}

}  // namespace segue::cli

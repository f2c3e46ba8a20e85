// SPDX-License-Identifier: Apache-2.0
#include "mission_pursuit.hpp"

#include <segue/base/text.hpp>
#include <segue/mission_run/run_control.hpp>
#include <segue/pddl/pddl_problem.hpp>

#include <fmt/core.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "../output.hpp"
#include "mission_run.hpp"

namespace segue::cli {

namespace {

using mission_run::LoadedMission;
using type::Value;

/// How many steps of its plan a mission has carried out; one after another.
std::size_t steps_done(const mission::Mission& mission, const mission_run::FinishedRun& run) {
  const auto rows = run.rows();
  std::size_t done = 0;
  while (done < rows.size() && rows[done].outcome == mission.actions[done].foreseen_outcome())
    ++done;
  return done;
}

class Pursuit {
 public:
  Pursuit(Goal goal, control::RobotService& service, const Context& context)
      : goal_(std::move(goal)),
        domain_(domain_of(goal_.mapping)),
        context_(context),
        robot_(service, "mission plan", {}, false),
        name_(goal_.mapping.name) {
    goal_.problem.from += ", as it is known now";
  }

  int run() {
    const Result<void> reached = pursue();
    const bool holds = static_cast<bool>(reached);
    const bool is_at_rest = robot_.leave(holds, name_);
    if (context_.json()) {
      Value document = Value::map({{"goal_holds", holds}, {"runs", runs_}});
      if (!holds) document.as_map().set("error", reached.error().message);
      print_json(document);
    } else if (holds) {
      print_line(fmt::format("{}: the goal holds after {}", printable(name_), counted(runs_.size(), "plan")));
    }
    if (!holds) tell(reached.error());
    return holds && is_at_rest ? kDone : kFailed;
  }

 private:
  /// Returns once the goal holds, or why it does not.
  Result<void> pursue() {
    for (;;) {
      if (auto known = learn(observe(goal_.mapping, robot_.robot())); !known) return known;
      if (goal_holds()) return {};
      if (runs_.size() >= goal_.most_plans) {
        return fail(ErrorCode::InvalidState,
                    fmt::format("the goal does not hold after {}", counted(runs_.size(), "plan")));
      }
      const auto plan = find_plan(goal_.planner, domain_, goal_.problem, robot_.stop());
      if (auto commands = commands_robot(); !commands) return commands;
      if (!plan) return plan.error();
      if (auto carried_out = carry_out(*plan); !carried_out) return carried_out;
    }
  }

  Result<void> learn(const std::vector<pddl::GroundAtom>& facts) {
    Diagnostics diagnostics;
    auto text = pddl::problem_with(goal_.problem.pddl(), facts, diagnostics);
    if (!text) return diagnostics.to_error();
    goal_.problem.text = std::move(*text);
    return {};
  }

  /// A plan without steps reaches the goal.
  [[nodiscard]] bool goal_holds() const {
    Diagnostics ignored;
    return pddl::read_pddl(domain_.pddl(), goal_.problem.pddl(), {"", "no steps"}, ignored).has_value();
  }

  /// Why this must not command the robot any more.
  Result<void> commands_robot() {
    if (robot_.stop().stop_requested()) return fail(ErrorCode::Cancelled, "it was stopped");
    const auto lost = robot_.robot()->lost_command({});
    if (!lost) return lost.error();
    return *lost ? fail(ErrorCode::InvalidState, **lost) : Result<void>();
  }

  /// Runs the mission of the plan. An error where nothing may be planned any more.
  Result<void> carry_out(const PlanningText& text) {
    Diagnostics diagnostics;
    const auto plan = pddl::read_pddl(domain_.pddl(), goal_.problem.pddl(), text.pddl(), diagnostics);
    auto mission =
        plan ? mission_of(goal_.mapping, *plan, goal_.mapping.name + ".yaml", diagnostics) : std::nullopt;
    if (!mission) return diagnostics.to_error();
    name_ = mission->name;
    const auto conflicts = robot_.take();
    if (!conflicts) return conflicts.error();
    const auto loaded = LoadedMission::create(std::move(*mission), &*conflicts);
    if (!loaded) return loaded.error();
    auto request = run_request({}, {}, false, steering_);
    if (!request) return request.error();
    const Ran run = robot_.run(*loaded, std::move(*request), steering_, {}, context_);
    if (!run) return run.error();
    keep(**run, *plan);
    if (auto commands = commands_robot(); !commands) return commands;
    return learn(pddl::effects_of(*plan, steps_done(loaded->program()->mission(), **run)));
  }

  /// For the document, or on standard output.
  void keep(mission_run::FinishedRun& run, const pddl::PddlPlan& plan) {
    Value::List steps;
    for (std::uint32_t i = 0; i < plan.network.size(); ++i)
      steps.emplace_back(plan.network.name_of(task_network::NodeId{i}));
    Value document = document_of(run, robot_.robot().get());
    document.as_map().set("plan", std::move(steps));
    runs_.push_back(std::move(document));
    if (!context_.json()) show_run(run, false, false, robot_.robot().get(), context_);
  }

  /// On standard error.
  static void tell(const Error& error) {
    const Diagnostics diagnostics = diagnostics_of(error);
    diagnostics.empty() ? print_error(Context{}, error) : print_diagnostics(diagnostics);
  }

  Goal goal_;
  const PlanningText domain_;
  const Context& context_;
  mission_run::RunControl steering_;
  MissionRobot robot_;
  std::string name_;  ///< of the last mission
  Value::List runs_;  ///< their documents
};

}  // namespace

int pursue(Goal goal, control::RobotService& service, const Context& context) {
  return Pursuit(std::move(goal), service, context).run();
}

}  // namespace segue::cli

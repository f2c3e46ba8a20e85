// SPDX-License-Identifier: Apache-2.0
#include "mission_run.hpp"

#include <segue/base/text.hpp>
#include <segue/draw/gantt.hpp>
#include <segue/draw/shown_plan.hpp>
#include <segue/mission/controllers.hpp>
#include <segue/mission/pool_actions.hpp>
#include <segue/mission/program.hpp>
#include <segue/mission_robot/controller_runner.hpp>
#include <segue/mission_robot/fact_observer.hpp>
#include <segue/mission_robot/pool_runner.hpp>
#include <segue/mission_run/loaded_mission.hpp>
#include <segue/mission_run/run_control.hpp>
#include <segue/mission_script/script_robot.hpp>
#include <segue/remote_robot/served_robot.hpp>

#include <fmt/core.h>
#include <unistd.h>

#include <memory>
#include <stop_token>
#include <utility>
#include <variant>

#include "../connection.hpp"
#include "../models.hpp"
#include "../output.hpp"
#include "../report_text.hpp"
#include "../rest.hpp"
#include "../stop_signal.hpp"
#include "mission_progress.hpp"
#include "mission_remote.hpp"

namespace segue::cli {

namespace {

using mission_run::FinishedRun;
using mission_run::LoadedMission;
using mission_run::RunRequest;

/// A robot that is not at rest by its own limit stops its devices, which takes seconds.
constexpr Duration kRestTimeout = std::chrono::minutes(2);
/// More do not help a reader; --format json has all.
constexpr std::size_t kMostRows = 1000;

MissionProgress::Style style_of(const MissionOptions& options, const Context& context) {
  using Style = MissionProgress::Style;
  if (options.follow) return context.json() ? Style::JsonEvents : Style::Events;
  if (!options.progress || context.json() || options.clock == "virtual") return Style::None;
  return errors_are_terminal() ? Style::Block : Style::Lines;
}

/// The plan of the run as it is known before; empty for a mission that runs sequentially.
draw::Diagram known_plan(const LoadedMission& plan, const RunRequest& request) {
  const auto* const concurrent = std::get_if<mission_run::Concurrent>(&request.mode);
  if (concurrent == nullptr) return {};
  mission_run::ConvertRequest wanted;
  wanted.inputs = request.inputs;
  wanted.facts = request.facts;
  wanted.order = request.order;
  wanted.strict = concurrent->strict;
  wanted.most = wanted.horizon;
  auto diagram = plan.convert(wanted);  // where it fails, so does the run
  return diagram ? std::move(*diagram) : draw::Diagram{};
}

Ran run_with_progress(const LoadedMission& plan, RunRequest request, const MissionOptions& options,
                      const std::stop_token& stop, const Context& context) {
  const auto style = style_of(options, context);
  const bool shows_plan = style == MissionProgress::Style::Block;
  MissionProgress progress(plan.name(), style, options.clock == "real",
                           shows_plan ? known_plan(plan, request) : draw::Diagram{});
  request.note = [&](const std::string& text) { progress.note(text); };
  auto* const sequential = std::get_if<mission_run::Sequential>(&request.mode);
  if (sequential != nullptr && sequential->stepping) {
    sequential->stepping->on_held = [&](const std::vector<std::string>& paths) {
      progress.note("held" + (paths.empty() ? "" : " before " + listed(paths)) +
                    "; it goes on with 'segue mission step' or 'resume'");
    };
  }
  if (style != MissionProgress::Style::None) {
    request.on_event = [&, further = request.on_event](const mission::StateEvent& event) {
      progress.observe(event);
      if (further) further(event);
    };
  }
  return plan.run(request, stop);
}

/// Whether the run needs a robot; one that is stepped does, too, since the steps are requested through it.
bool needs_robot(const LoadedMission& plan, const MissionOptions& options) {
  if (plan.program() == nullptr) return false;
  const bool is_stepped = !options.breakpoints.empty() || options.steps_back;
  return is_stepped || options.through_robot ||
         (!options.simulate && mission::needs_robot(plan.program()->mission()));
}

void show_executions(const FinishedRun& run) {
  using Align = Table::Align;
  Table table({{"START", Align::Right},
               {"DURATION", Align::Right},
               {"STATE", Align::Left},
               {"OUTCOME", Align::Left}});
  const auto& overview = run.overview();
  for (const mission_run::RunRow& row : run.rows(kMostRows)) {
    table.add({format_seconds(seconds(row.start)), format_seconds(seconds(row.end - row.start)),
               printable(row.name), row.outcome.empty() ? "running" : printable(row.outcome)});
  }
  print(table.text());
  if (overview.actions > kMostRows)
    print_note(fmt::format("{} more actions are not shown", overview.actions - kMostRows));
  print_line(fmt::format("{}: {} after {}, {}", printable(overview.name), printable(overview.outcome),
                         format_seconds(seconds(overview.makespan)), counted(overview.actions, "action")));
  if (overview.error) print_note(printable(overview.error->message));
}

void show_speculation(const task_network::SpeculationSummary& speculation) {
  if (speculation.used + speculation.discarded == 0) return;
  print_line(fmt::format(
      "ahead: {} used, {:.2f} s of them before it was certain that they count; {} discarded, {:.2f} s",
      speculation.used, seconds(speculation.ahead), speculation.discarded,
      seconds(speculation.discarded_time)));
}

void show_nodes(FinishedRun& run) {
  using Align = Table::Align;
  Table table({{"node"}, {"start", Align::Right}, {"end", Align::Right}, {"status"}, {"last waited for"}});
  std::size_t off_path = 0;
  for (const mission_run::RunRow& row : run.rows()) {
    const bool skipped = row.status == task_network::NodeStatus::Skipped;
    if (skipped && !row.started) {
      ++off_path;
      continue;
    }
    const auto time = [&](Duration when) {
      return row.started ? fmt::format("{:.2f}", seconds(when)) : std::string("-");
    };
    table.add({printable(row.name), time(row.start), time(row.end),
               skipped ? "discarded" : std::string(to_string(row.status)), printable(row.waited_for)});
  }
  print(table.text());
  if (off_path > 0) print_line(fmt::format("and {} not on the path taken", off_path));
  const task_network::RunSummary& comparison = run.comparison();
  show_speculation(comparison.speculation);
  print_line(fmt::format("{} in {:.2f} s; sequential {:.2f} s, critical path {:.2f} s",
                         run.overview().succeeded ? "done" : "ended", seconds(run.overview().makespan),
                         seconds(comparison.sequential), seconds(comparison.critical_path)));
  for (const std::string& cause : run.why_in_sequence())
    print_line(printable(cause));
}

}  // namespace

type::Value document_of(FinishedRun& run, const remote_robot::ServedRobot* robot) {
  type::Value document = run.to_value();
  if (robot == nullptr) return document;
  const auto saved = robot->saved();
  document.as_map().set("look_ahead",
                        type::Value::map({{"saved_s", seconds(saved.saved)},
                                          {"transitions", static_cast<std::uint64_t>(saved.transitions)}}));
  return document;
}

void show_run(FinishedRun& run, bool is_network, bool follows, const remote_robot::ServedRobot* robot,
              const Context& context) {
  if (context.json()) {
    const type::Value document = document_of(run, robot);
    return follows ? print_json_line(document) : print_json(document);
  }
  const auto& overview = run.overview();
  run.as_written() ? show_executions(run) : show_nodes(run);
  if (is_network) return;
  if (!run.as_written())
    print_line(fmt::format("{}: {}", printable(overview.name), printable(overview.outcome)));
  for (const auto& [port, value] : overview.outputs)
    print_line(fmt::format("{}: {}", printable(port), one_line(value)));
  if (overview.error && !run.as_written()) print_note(printable(overview.error->message));
  if (robot == nullptr) return;
  if (const auto saved = robot->saved(); saved.transitions > 0)
    print_line(saving_line(seconds(saved.saved), saved.transitions));
}

namespace {

/// Lets the robot's pools carry out actions that are calls of pools. A pool has as many units as it may have
/// instances, unless the user has given another number.
Result<void> add_pools(RunRequest& request, const LoadedMission& plan,
                       const std::shared_ptr<remote_robot::ServedRobot>& robot,
                       const mission::ControllerOptions& how) {
  if (plan.program() == nullptr || !mission::uses_pools(plan.program()->mission())) return {};
  const auto pools = robot->pools(Wait(TimePoint::max()));
  if (!pools) return pools.error();
  const auto units = mission::pool_units(plan.program()->mission(), *pools);
  if (!units) return units.error();
  request.resources.insert(units->begin(), units->end());
  mission::PoolOptions of_pools;
  of_pools.unreachable = how.unreachable;
  request.runners.set_pools(std::make_shared<mission::PoolRunner>(robot, of_pools));
  return {};
}

}  // namespace

Result<void> run_by_robot(RunRequest& request, const LoadedMission& plan,
                          const std::shared_ptr<remote_robot::ServedRobot>& robot,
                          const mission::ControllerOptions& how,
                          std::shared_ptr<mission::ControllerUnion> controllers) {
  if (auto units = add_pools(request, plan, robot, how); !units) return units;
  if (!controllers) {
    controllers = std::make_shared<mission::ControllerUnion>(
        robot, mission::ControllerUnion::Options{.deadline = how.request_deadline});
  }
  request.runners.set_controllers(std::make_shared<mission::ControllerRunner>(robot, how, controllers));
  mission::ScriptRobotOptions of_scripts;
  of_scripts.unreachable = how.unreachable;
  if (request.scripts)
    request.scripts->robot = std::make_shared<mission::ScriptRobot>(robot, controllers, of_scripts);
  if (!request.simulate) request.units = robot;
  if (mission::observes(plan.program()->mission()) && !request.simulate) {
    mission::FactObserver::Options of_facts;
    of_facts.unreachable = how.unreachable;
    request.runners.set_observer(
        std::make_shared<mission::FactObserver>(robot, plan.program()->mission(), of_facts));
  }
  return {};
}

namespace {

type::Value shown_plan(const LoadedMission& plan, const RunRequest& request,
                       MissionRemote::PlanDetail detail) {
  if (!std::holds_alternative<mission_run::Concurrent>(request.mode))
    return draw::shown_plan(*plan.program(), nullptr);
  if (detail == MissionRemote::PlanDetail::Whole) {
    const draw::Diagram diagram = known_plan(plan, request);
    return draw::shown_plan(*plan.program(), &diagram);
  }
  type::Value outline = draw::shown_plan(*plan.program(), nullptr);
  outline.as_map().set("outline", true);
  return outline;
}

/// `robot` as of show_run().
int show(const Ran& run, const LoadedMission& plan, const MissionOptions& options,
         const remote_robot::ServedRobot* robot, const Context& context) {
  if (!run) return failed(context, run.error());
  if (options.show) show_run(**run, plan.is_network(), options.follow, robot, context);
  if (options.files.any()) {
    // Standard output has had its document.
    const auto written = write(options.files, (*run)->gantt());
    if (!written) return failed(Context{}, written.error());
  }
  const mission_run::RunOverview& overview = (*run)->overview();
  if (overview.succeeded) return kDone;
  const bool has_told = !plan.is_network() || (options.show && context.json());
  return overview.error && !has_told ? failed(context, *overview.error) : kFailed;
}

void tell_end(const Ran& run, MissionRemote& remote) {
  if (!run) return remote.ended("aborted", run.error().message);
  const mission_run::RunOverview& overview = (*run)->overview();
  remote.ended(overview.outcome, overview.error ? overview.error->message : "");
}

}  // namespace

MissionRobot::MissionRobot(control::RobotService& service, std::string_view verb,
                           mission::ControllerOptions how, bool stops_if_unreachable, int input)
    : signal_(input),
      robot_(std::make_shared<remote_robot::ServedRobot>(service, sender(verb))),
      how_(std::move(how)),
      controllers_(std::make_shared<mission::ControllerUnion>(
          robot_, mission::ControllerUnion::Options{.deadline = how_.request_deadline})) {
  robot_->when_stopped([stop = stop_]() mutable { stop.request_stop(); });
  if (!stops_if_unreachable) return;
  how_.unreachable = [stop = stop_, is_unreachable = is_unreachable_](const Error& /*why*/) mutable {
    *is_unreachable = true;
    stop.request_stop();
  };
}

Result<mission::ControllerConflicts> MissionRobot::take() {
  if (auto taken = robot_->take(); !taken) return taken.error();
  return robot_->conflicts(Wait(TimePoint::max()));
}

Ran MissionRobot::run(const LoadedMission& plan, RunRequest request, mission_run::RunControl& steering,
                      const MissionOptions& options, const Context& context) {
  const RunRequest planned = request;
  if (auto given = run_by_robot(request, plan, robot_, how_, controllers_); !given) return given.error();
  remote_.reset();
  remote_.emplace(
      *robot_, *plan.program(),
      [plan, planned](MissionRemote::PlanDetail detail) { return shown_plan(plan, planned, detail); },
      std::holds_alternative<mission_run::Concurrent>(planned.mode) ? "concurrent" : "sequential", steering,
      stop_);
  request.on_event = [this](const mission::StateEvent& event) { remote_->observe(event); };
  Ran run = run_with_progress(plan, std::move(request), options, stop_.get_token(), context);
  tell_end(run, *remote_);
  return run;
}

bool MissionRobot::leave(bool keep, const std::string& name) {
  remote_.reset();
  const auto rest = robot_->give_back(keep, deadline_in(kRestTimeout));
  if (!rest) {
    // Whoever took the robot over, or has halted it, has been named as the reason why the mission ended.
    if (!*is_unreachable_ && rest.error().code != ErrorCode::InvalidState)
      print_note("it is not known whether the robot is at rest: " + rest.error().message);
    return keep;
  }
  if (rest->is_null()) return true;
  print_note(rest_text(name, *rest));
  return cli::is_at_rest(*rest);
}

namespace {

/// The end of which preempts the run; -1: none does.
int input_of(const MissionOptions& options) {
  return options.until_eof ? STDIN_FILENO : -1;
}

/// Lets the robot carry out actions that are controllers. The plan is made anew, since it depends on which
/// controllers the robot can run at once. `steering` is that of the request.
int run_on_robot(RunRequest request, mission_run::RunControl& steering, const MissionOptions& options,
                 control::RobotService& service, const Context& context) {
  mission::ControllerOptions how;
  how.look_ahead = options.look_ahead;
  const bool can_be_resumed = request.journal.has_value();
  const std::string verb = "mission run" + (options.asked_by.empty() ? "" : " for " + options.asked_by);
  MissionRobot robot(service, verb, how, can_be_resumed, input_of(options));
  const auto conflicts = robot.take();
  if (!conflicts) return failed(context, conflicts.error());
  const auto plan =
      LoadedMission::load(options.file, {.libraries = options.libraries, .conflicts = &*conflicts});
  if (!plan) return report_failure(context, plan.error());
  const Ran run = robot.run(*plan, std::move(request), steering, options, context);
  const bool keeps = (run && (*run)->overview().succeeded) ||
                     plan->program()->mission().at_end == mission::Mission::AtEnd::Keep;
  const bool is_at_rest = robot.leave(keeps, plan->name());
  const int status = show(run, *plan, options, robot.robot().get(), context);
  if (robot.is_unreachable())
    print_note("the robot cannot be reached any more; when it runs again, the mission goes on with --resume");
  return is_at_rest ? status : std::max<int>(status, kFailed);
}

/// States that options name must be known before a robot is commanded.
Result<void> check_places(const LoadedMission& plan, const MissionOptions& options) {
  if (plan.program() == nullptr) return {};
  std::vector<std::string> paths = options.breakpoints;
  if (!options.start_at.empty()) paths.push_back(options.start_at);
  for (const std::string& path : paths) {
    if (auto states = plan.program()->states_on(path); !states) return states.error();
  }
  return {};
}

}  // namespace

int run_plan(const MissionOptions& options, const NetworkOptions& network, Context& context) {
  if (const auto fits = check(options.files); !fits) return failed(context, fits.error());
  if (context.json() && options.files.use_output()) {
    return failed(context, fail(ErrorCode::InvalidArgument,
                                "with --format json drawings go to files, not to standard output"));
  }
  const auto plan = LoadedMission::load(options.file, {.libraries = options.libraries});
  if (!plan) return report_failure(context, plan.error());
  print_diagnostics(plan->warnings());
  if (const auto known = check_places(*plan, options); !known) return failed(context, known.error());
  mission_run::RunControl steering;
  auto request = run_request(options, network, plan->is_network(), steering);
  if (!request) return failed(context, request.error());
  if (!needs_robot(*plan, options)) {
    StopSignal stop(input_of(options));  // until the run has been shown
    return show(run_with_progress(*plan, *request, options, stop.token(), context), *plan, options, nullptr,
                context);
  }
  if (options.clock == "virtual") {
    return failed(context, fail(ErrorCode::InvalidArgument,
                                "a robot cannot run in virtual time; simulate the mission with --simulate"));
  }
  return with_robot(context, [&](control::RobotService& robot) {
    return run_on_robot(std::move(*request), steering, options, robot, context);
  });
}

}  // namespace segue::cli

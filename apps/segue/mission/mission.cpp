// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/pddl/pddl.hpp>
#include <segue/rafcon/rafcon.hpp>
#include <segue/task_network/flat_file.hpp>

#include <fmt/core.h>

#include <memory>

#include "../models.hpp"
#include "../output.hpp"
#include "checked_missions.hpp"
#include "mission_convert.hpp"
#include "mission_plan.hpp"
#include "mission_request.hpp"
#include "mission_run.hpp"
#include "mission_steering.hpp"

namespace segue::cli {

namespace {

int check_missions(const std::vector<std::string>& files, const MissionOptions& options,
                   const Context& context) {
  Diagnostics diagnostics;
  CheckedMissions missions(options.libraries);
  for (const std::string& file : files)
    missions.check(file, diagnostics);
  diagnostics.sort();
  print_diagnostics(diagnostics);
  if (context.json()) {
    print_json(missions.to_value(diagnostics));
    return diagnostics.has_errors() ? kFailed : kDone;
  }
  missions.print();
  if (diagnostics.empty()) {
    print_line(files.size() == 1 ? "no problems" : fmt::format("{} files: no problems", files.size()));
  }
  return diagnostics.has_errors() ? kFailed : kDone;
}

struct ImportOptions {
  std::string folder;             ///< of a RAFCON machine
  std::vector<std::string> pddl;  ///< domain, problem, plan
  std::string output;
  std::vector<std::string> libraries;
};

int import_rafcon(const ImportOptions& options, const Context& context) {
  Diagnostics diagnostics;
  const auto machine =
      mission::import_rafcon(options.folder, mission::rafcon_library_paths(options.libraries), diagnostics);
  if (!machine) return report_failure(context, diagnostics);
  const std::string text = mission::write_mission(machine->mission);
  if (const int status = write_or_print(context, options.output, text); status != kDone) return status;
  // Problems are reported with their places in the new file, where they can be fixed.
  if (!options.output.empty()) (void)mission::load_mission(options.output, {}, diagnostics);
  print_diagnostics(diagnostics);
  const auto& counts = machine->counts;
  if (!options.output.empty())
    print_note(fmt::format("{}: {} states, {} of them libraries, {} transitions, {} data flows",
                           options.output, counts.states, counts.library_states, counts.transitions,
                           counts.data_flows));
  return kDone;
}

int import_pddl(const ImportOptions& options, const Context& context) {
  Diagnostics diagnostics;
  auto plan = pddl::load_pddl(options.pddl[0], options.pddl[1], options.pddl[2], diagnostics);
  if (!plan) return report_failure(context, diagnostics);
  print_diagnostics(diagnostics);
  return write_or_print(context, options.output,
                        task_network::write_flat_network({std::move(plan->network), {}}));
}

int import_plan(const ImportOptions& options, const Context& context) {
  if (!options.folder.empty()) return import_rafcon(options, context);
  if (!options.pddl.empty()) return import_pddl(options, context);
  print_error(context, fail(ErrorCode::InvalidArgument, "select what to import: --rafcon or --pddl"));
  return kUsage;
}

void add_mode_option(Verb& verb, MissionOptions& options) {
  verb.option("--mode MODE", options.mode,
              "sequential (default of missions), or concurrent (default of task networks)")
      .one_of({"sequential", "concurrent"});
}

/// Options for a run that records a journal, and for one that resumes an interrupted run.
void add_journal_options(Verb& runner, MissionOptions& options, const Option& steps_back) {
  const Option journal =
      runner.option("--journal FILE", options.journal, "record the run, so that it can be resumed")
          .excludes(steps_back);
  const Option resume =
      runner.flag("--resume", options.resume, "continue the interrupted run of that journal").needs(journal);
  runner
      .option("--under-way HOW", options.under_way,
              "what to do about actions that were running then: go-on (default) watches the controllers of a "
              "robot that run still; again, skip or abort")
      .needs(resume)
      .one_of({"go-on", "again", "skip", "abort"});
}

void add_runner(Verb& verb, Context& context) {
  const auto options = std::make_shared<MissionOptions>();
  const auto network = std::make_shared<NetworkOptions>();
  Verb& runner = add_verb(verb, context, "run", "run a mission, or a task network",
                          "  segue mission run fetch.yaml\n"
                          "  segue mission run fetch.yaml --clock virtual --simulate --format json\n"
                          "  segue mission run fetch.json --clock virtual\n"
                          "  segue mission run fetch.yaml --follow      # every event as it happens\n"
                          "  segue mission run patrol.yaml --robot rover  # whose actions are controllers",
                          [options, network, &context] { return run_plan(*options, *network, context); });
  runner.option("FILE", options->file, "a mission file, a RAFCON machine's folder or a task network")
      .required();
  add_mode_option(runner, *options);
  runner.option("--clock CLOCK", options->clock, "real (default), or virtual: simulated actions take no time")
      .one_of({"real", "virtual"});
  runner.flag("--simulate", options->simulate,
              "simulate every action with its expected duration and outcome");
  runner.option("--input NAME=VALUE", options->inputs, "an input of the mission");
  runner.option("--fact FACT", options->facts, "a fact that initially holds, or with '!' does not hold");
  runner.option(
      "--look-ahead N", options->look_ahead,
      "on a robot, keep at most so many controllers prepared that are likely to be needed next (default 3)");
  runner.option("--start-at PATH", options->start_at, "begin at this state, such as fetch/grasp");
  const Option steps_back =
      runner.flag("--steps-back", options->steps_back,
                  "on a robot, keep what is needed to undo steps: segue mission step back");
  runner.option(
      "--break PATH", options->breakpoints,
      "on a robot, be held before this state until `segue mission step` or `resume`, or the studio");
  add_journal_options(runner, *options, steps_back);
  runner.flag("--through-robot", options->through_robot,
              "let the robot show, steer and record the run, even where no action needs the robot");
  runner.option("--for WHO", options->asked_by, "on a robot, who has asked for the run, for its journal");
  runner.flag("--until-eof", options->until_eof,
              "preempt it when standard input ends, too: for programs that start missions");
  runner.option("--python PROGRAM", options->python, "the interpreter of Python scripts; default: python3");
  runner.flag("-f,--follow", options->follow,
              "print every state or node that begins or ends, as it happens; in JSON one a line");
  runner.flag("--progress,!--no-progress", options->progress,
              "in real time, show what runs, has ended and waits, on standard error (default)");
  add_library_option(runner, *options);
  add_network_options(runner, *network);
  add_run_files(runner, options->files);
  add_robot_option(runner, context);
}

/// Runs in virtual time and prints nothing but the drawing, if that goes to no file.
void add_gantt(Verb& parent, Context& context) {
  const auto options = std::make_shared<MissionOptions>();
  const auto network = std::make_shared<NetworkOptions>();
  Verb& verb = add_verb(parent, context, "gantt", "draw a run in virtual time as a Gantt chart (SVG)",
                        "  segue mission gantt fetch.json -o fetch.svg\n"
                        "  segue mission gantt fetch.json --mode sequential -o before.svg",
                        [options, network, &context] {
                          options->clock = "virtual";
                          options->simulate = true;
                          // In JSON it prints the run. Otherwise it prints the chart, unless that goes to a
                          // file.
                          options->show = context.json();
                          if (options->files.svg.empty() && !context.json()) options->files.svg = "-";
                          return run_plan(*options, *network, context);
                        });
  verb.option("FILE", options->file, "a mission file, a RAFCON machine's folder or a task network")
      .required();
  add_mode_option(verb, *options);
  verb.option("-o,--output FILE", options->files.svg, "write to a file instead of standard output");
  add_page_and_trace(verb, options->files);
  add_library_option(verb, *options);
  add_network_options(verb, *network);
}

void add_convert(Verb& parent, Context& context) {
  const auto options = std::make_shared<ConvertOptions>();
  Verb& verb =
      add_verb(parent, context, "convert", "show a plan as a task network, and the reasons for its order",
               "  segue mission convert fetch.yaml\n"
               "  segue mission convert fetch.yaml --svg -o fetch.svg\n"
               "  segue mission convert loops.yaml --assume-expected --horizon 200",
               [options, &context] { return convert_plan(*options, context); });
  verb.option("FILE", options->mission.file, "a mission file, a RAFCON machine's folder or a task network")
      .required();
  const Option dot = verb.flag("--dot", options->dot, "a graph for Graphviz");
  verb.flag("--svg", options->svg, "a drawing of the nodes and their dependencies").excludes(dot);
  verb.option("-o,--output FILE", options->output, "a file instead of standard output");
  verb.option("--horizon N", options->horizon,
              "nodes of a mission that are planned; default: 1000, as in a run")
      .between(1, 100'000'000);
  verb.flag("--assume-expected", options->assume_expected,
            "plan beyond decisions, as if actions ended as simulated or expected");
  verb.option("--input NAME=VALUE", options->mission.inputs, "an input of the mission");
  verb.option("--fact FACT", options->mission.facts,
              "a fact that initially holds, or with '!' does not hold");
  verb.option("--order ORDER", options->order,
              "of a task network: epoch (default) keeps the whole final world, goal only its goal")
      .one_of({"epoch", "goal"});
  verb.flag(
      "--strict", options->strict,
      "whatever remains waits until nothing before it can fail any more, as if all were declared strict");
  add_library_option(verb, options->mission);
}

}  // namespace

void add_mission(Verb& app, Context& context) {
  Verb& verb = add_verb(
      app, context, "mission", "run, check and convert missions and task networks",
      "  segue mission run fetch.yaml\n  segue mission import --rafcon machine -o machine.yaml", nullptr);
  verb.require_verb();
  add_runner(verb, context);

  const auto files = std::make_shared<std::vector<std::string>>();
  const auto options = std::make_shared<MissionOptions>();
  Verb& checker = add_verb(verb, context, "check",
                           "validate missions and list what may happen although something earlier fails",
                           "  segue mission check missions/*.yaml",
                           [files, options, &context] { return check_missions(*files, *options, context); });
  checker.option("FILE", *files, "mission files").required();
  add_library_option(checker, *options);

  const auto source = std::make_shared<ImportOptions>();
  Verb& importer = add_verb(verb, context, "import", "convert other plans to mission files and task networks",
                            "  segue mission import --rafcon my_machine --libraries "
                            "generic=/opt/rafcon/libraries/generic -o m.yaml",
                            [source, &context] { return import_plan(*source, context); });
  const Option rafcon =
      importer.option("--rafcon DIR", source->folder, "the folder of a RAFCON state machine");
  importer
      .option("--pddl DOMAIN PROBLEM PLAN", source->pddl,
              "a domain, a problem and a sequential plan, as a task network")
      .takes(3)
      .excludes(rafcon);
  importer.option("--libraries NAME=DIR", source->libraries, "RAFCON's library paths");
  importer.option("-o,--output FILE", source->output, "write to a file instead of standard output");
  add_gantt(verb, context);
  add_convert(verb, context);
  add_mission_plan(verb, context);
  add_mission_steering(verb, context);
}

}  // namespace segue::cli

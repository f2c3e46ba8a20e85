// SPDX-License-Identifier: Apache-2.0
#include "bench_transitions.hpp"

#include <segue/base/file.hpp>
#include <segue/base/log.hpp>
#include <segue/base/text.hpp>
#include <segue/runtime/embedded_robot.hpp>
#include <segue/runtime/runtime.hpp>

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>

#include "../command.hpp"
#include "../output.hpp"
#include "../stop_signal.hpp"
#include "bench_experiment.hpp"
#include "bench_files.hpp"
#include "number_list.hpp"

namespace segue::cli {

namespace {

constexpr std::size_t kMostWalks = 10'000;

struct TransitionsOptions {
  std::string robot;
  std::string stand_ins;
  bool stand_in = false;
  bool in_process = false;
  std::size_t repetitions = 10;
  std::vector<std::string> controllers;
  std::vector<double> published;
  std::uint32_t table = 0;  ///< of the paper; 0: none
  std::string folder;
};

/// Table 5 of the paper: the Artemis rover, in seconds, row by row.
struct PaperMatrix {
  const char* robot = "robot.yaml";
  std::vector<std::string> controllers = {"search_explore", "goal_navigation", "manipulation",
                                          "manipulator_teleop"};
  std::vector<double> seconds = {0.52, 0.55, 4.08, 0.11, 0.59, 4.06, 0.18, 0.62, 4.16, 2.01, 2.29, 2.23};
};

/// Fills in what the table is about and is not given.
Result<TransitionsOptions> with_paper_table(TransitionsOptions options) {
  if (options.table == 0) {
    if (!options.robot.empty()) return options;
    return fail(ErrorCode::InvalidArgument, "name the robot file, or the table of the paper (--table 5)");
  }
  const PaperMatrix table;
  if (options.robot.empty()) options.robot = table.robot;
  if (options.controllers.empty()) {
    options.controllers = table.controllers;
    if (options.published.empty()) options.published = table.seconds;
  }
  options.stand_in = true;
  return options;
}

Result<void> parse_seconds(const std::string& text, std::vector<double>& seconds) {
  const auto numbers = parse_number_list<double>(text);
  if (!numbers)
    return fail(ErrorCode::InvalidArgument, "expected seconds, separated by commas, got " + quote(text));
  seconds.insert(seconds.end(), numbers->begin(), numbers->end());
  return {};
}

Result<runtime::EmbeddedRobot> open_robot(const TransitionsOptions& options) {
  runtime::EmbeddedOptions embedded;
  embedded.stand_in = options.stand_in || !options.stand_ins.empty();
  embedded.stand_ins = options.stand_ins;
  embedded.placement =
      options.in_process ? runtime::TaskPlacement::InProcess : runtime::TaskPlacement::Processes;
  embedded.log_level = LogLevel::Error;
  return runtime::EmbeddedRobot::open(options.robot, embedded);
}

/// The controllers that are named, else all.
Result<std::vector<std::string>> controllers_of(runtime::EmbeddedRobot& robot,
                                                const TransitionsOptions& options) {
  std::vector<std::string> known;
  for (const model::NetworkName& name : robot.runtime().controllers())
    known.push_back(name.str());
  for (const std::string& name : options.controllers) {
    if (std::ranges::find(known, name) == known.end())
      return fail(ErrorCode::NotFound,
                  "the robot has no controller " + quote(name) + did_you_mean(name, known));
  }
  std::vector<std::string> controllers = options.controllers.empty() ? known : options.controllers;
  if (controllers.size() < 2)
    return fail(ErrorCode::InvalidArgument, "the robot has fewer than two controllers to switch between");
  const std::size_t count = controllers.size() * (controllers.size() - 1);
  if (options.published.empty() || options.published.size() == count) return controllers;
  return fail(ErrorCode::InvalidArgument,
              fmt::format("{} controllers have {} transitions; {} published figures are given",
                          controllers.size(), count, options.published.size()));
}

Result<void> measure_walk(runtime::EmbeddedRobot& robot, const std::vector<std::string>& walk,
                          TransitionsReport& report, StopSignal& stop) {
  for (std::size_t i = 0; i < walk.size() && !stop.requested(); ++i) {
    const TimePoint begin = RealClock::instance().now();
    const auto result = robot.switch_to(walk[i]);
    const std::chrono::duration<double> took = RealClock::instance().now() - begin;
    if (!result.ok())
      return fail(ErrorCode::HookFailed,
                  "the switch to " + quote(walk[i]) + " was not done: " + result.why());
    if (i > 0) add_switch(report.transitions[{walk[i - 1], walk[i]}], result, took.count());
  }
  return {};
}

Result<void> measure_transitions(const TransitionsOptions& options, TransitionsReport& report,
                                 StopSignal& stop) {
  auto robot = open_robot(options);
  if (!robot) return robot.error();
  auto controllers = controllers_of(*robot, options);
  if (!controllers) return controllers.error();
  report.robot = robot->robot().name;
  report.controllers = std::move(*controllers);
  report.published = options.published;
  const auto walk = walk_between(report.controllers);
  Progress progress;
  Result<void> measured;
  for (std::size_t i = 0; i < options.repetitions && measured && !stop.requested(); ++i) {
    progress.show(fmt::format("transitions: repetition {} of {}", i + 1, options.repetitions));
    measured = measure_walk(*robot, walk, report, stop);
  }
  const auto stopped = robot->shut_down();
  if (measured && !stopped.ok())
    return fail(ErrorCode::HookFailed, "the robot did not stop cleanly: " + stopped.why());
  return measured;
}

Result<void> write_transitions(const std::string& folder, const TransitionsReport& report) {
  return write_file(std::filesystem::path(folder) / "transitions.csv", transitions_csv(report));
}

int bench_transitions(const TransitionsOptions& given, const Context& context) {
  const auto options = with_paper_table(given);
  if (!options) return failed(context, options.error());
  StopSignal stop;
  if (!options->folder.empty()) {
    if (auto made = make_bench_folder(options->folder); !made) return failed(context, made.error());
  }
  set_log_level(LogLevel::Error);
  TransitionsReport report;
  const auto measured = measure_transitions(*options, report, stop);
  if (!report.transitions.empty()) {
    if (!context.json()) print(transitions_text(report));
    if (!options->folder.empty()) {
      if (auto written = write_transitions(options->folder, report); !written)
        return failed(context, written.error());
    }
  }
  if (!measured) return failed(context, measured.error());
  if (context.json()) print_json(transitions_value(report));
  if (!stop.requested()) return kDone;
  print_note("interrupted; this is what was measured until then");
  return kFailed;
}

constexpr const char* kTransitionsHelp =
    "  segue bench transitions robot.yaml\n"
    "  segue bench transitions robot.yaml --stand-in --repetitions 3 --out results\n"
    "  cd examples/04_artemis && segue bench transitions --table 5\n\n"
    "Starts the robot, switches from each of its controllers to each other one, several times, and prints "
    "how\n"
    "long each transition took from the request until all was done, how many actions it has, and which were\n"
    "slowest: Tables 5 to 7 of M. Wirkus et al., 2020, with any robot. --table 5: the paper's rover with\n"
    "stand-ins, beside the published times, which its real drivers took. Close other programs first. Ctrl-C\n"
    "stops the robot and prints what was measured until then.\n";

}  // namespace

void add_bench_transitions(Verb& bench, Context& context) {
  const auto options = std::make_shared<TransitionsOptions>();
  Verb& verb =
      add_verb(bench, context, "transitions", "measure all transitions between a robot's controllers",
               kTransitionsHelp, [options, &context] { return bench_transitions(*options, context); });
  verb.option("ROBOT", options->robot, "the robot file");
  verb.option("--table N", options->table,
              "table 5 of the paper, its rover's transitions, in examples/04_artemis")
      .between(5, 5);
  verb.option("--repetitions N", options->repetitions, "how often each is executed (default 10)")
      .between(1, kMostWalks);
  verb.option("--controller NAME", options->controllers,
              "a controller to switch from and to; may be repeated (default: all)")
      .takes_one_at_a_time();
  verb.option(
      "--published SECONDS,...",
      [options](const std::string& text) { return parse_seconds(text, options->published); },
      "figures to show beside, row by row");
  verb.flag("--stand-in", options->stand_in,
            "use a stand-in (simulated component) for each component that is not installed");
  verb.option("--stand-ins FILE", options->stand_ins,
              "configure the behaviour of stand-ins with this file; implies --stand-in");
  verb.flag("--in-process", options->in_process, "all tasks in this process");
  verb.option("--out DIR", options->folder, "also write every execution as CSV");
}

}  // namespace segue::cli

// SPDX-License-Identifier: Apache-2.0
#include "bench_mission.hpp"

#include <segue/base/log.hpp>
#include <segue/base/text.hpp>
#include <segue/model/robot.hpp>
#include <segue/type/yaml.hpp>

#include <fmt/core.h>

#include <algorithm>
#include <memory>

#include "../command.hpp"
#include "../mission/mission_run.hpp"
#include "../output.hpp"
#include "../stop_signal.hpp"
#include "bench_files.hpp"

namespace segue::cli {

namespace {

struct MissionBenchOptions {
  MissionExperiment experiment;
  std::uint64_t table = 0;  ///< of the paper; 0: none
  std::string robot;
  std::string mission;
  std::vector<std::string> inputs;
  std::vector<std::string> sweeps;
  std::vector<std::string> pools;
  std::string folder;
};

constexpr std::size_t kMostMissionRuns = 10'000;
constexpr int kMostAttempts = 4;  ///< at a run with a robot at its pace

/// "NAME=VALUE,...": values as in YAML.
Result<void> add_factor(const std::string& text, MissionFactor::Kind kind,
                        std::vector<MissionFactor>& factors) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    return fail(ErrorCode::InvalidArgument, "expected NAME=VALUE,..., got " + quote(text));
  const std::string name = text.substr(0, equals);
  auto values = type::parse_yaml("[" + text.substr(equals + 1) + "]");
  if (!values) return values.error();
  if (!values->is_list() || values->as_list().empty())
    return fail(ErrorCode::InvalidArgument, "no values in " + quote(text));
  if (kind == MissionFactor::Kind::Input && name.find('.') != std::string::npos)
    kind = MissionFactor::Kind::Property;
  for (const type::Value& value : values->as_list()) {
    const bool fits = value.kind() == type::Value::Kind::Int && value.as_int() >= 1 &&
                      value.as_int() <= model::kLargestPool;
    if (kind == MissionFactor::Kind::PoolSize && !fits)
      return fail(ErrorCode::InvalidArgument, fmt::format("a pool has between 1 and {} instances, not {}",
                                                          model::kLargestPool, one_line(value)));
  }
  factors.push_back({kind, name, std::move(values->as_list())});
  return {};
}

std::vector<std::string> texts(std::string_view separated_by_commas) {
  const auto parts = split(separated_by_commas, ',');
  return {parts.begin(), parts.end()};
}

/// The run that an earlier combination has made already, since sequential runs are the same for both.
const MissionRun* earlier_run(const MissionExperiment& experiment, const std::vector<MissionCell>& cells,
                              const MissionSetting& setting, std::uint64_t seed) {
  if (experiment.sequential_pools == 0) return nullptr;
  for (const MissionCell& cell : cells) {
    if (sequential_setting(experiment, cell.setting) != sequential_setting(experiment, setting)) continue;
    for (const MissionRun& run : cell.runs) {
      if (!run.concurrent && run.seed == seed) return &run;
    }
  }
  return nullptr;
}

/// How fast the robot's clock went, of real time; 1 where it has none, or nothing was timed.
double pace_of(const MissionRun& run) {
  return run.robot && run.wall.makespan > 0 ? run.robot->makespan / run.wall.makespan : 1;
}

/// A run in which the robot's clock was too slow is made again.
Result<MissionRun> run_at_pace(const MissionExperiment& experiment, const MissionSetting& setting,
                               bool concurrent, std::uint64_t seed, const std::stop_token& stop) {
  double pace = 0;
  for (int attempt = 0; attempt < kMostAttempts; ++attempt) {
    auto run = run_mission_afresh(experiment, setting, concurrent, seed, stop);
    if (!run || stop.stop_requested() || experiment.any_pace) return run;
    pace = pace_of(*run);
    if (pace >= kLeastPace) return run;
  }
  return fail(
      ErrorCode::ResourceExhausted,
      fmt::format("in each of {} attempts, the last time at {:.2f} of real time, the robot's clock was "
                  "too slow, so its planners had more time than on a robot: close other programs, or "
                  "give --any-pace to measure all the same",
                  kMostAttempts, pace));
}

/// Adds runs to the last cell until it is whole, or an interruption, which leaves out the run under way.
Result<void> measure_mission_cell(const MissionExperiment& experiment, std::vector<MissionCell>& cells,
                                  const std::string& where, StopSignal& stop) {
  Progress progress;
  MissionCell& cell = cells.back();
  for (std::uint64_t seed = 1; seed <= experiment.runs; ++seed) {
    // By turns, so that a load that changes slowly disturbs both modes alike.
    for (const bool concurrent : {seed % 2 == 0, seed % 2 != 0}) {
      if (const auto* earlier = concurrent ? nullptr : earlier_run(experiment, cells, cell.setting, seed)) {
        cell.runs.push_back(MissionRun(*earlier));
        continue;
      }
      progress.show(fmt::format("{}, run {} {}", where, seed, concurrent ? "concurrently" : "sequential"));
      auto run = run_at_pace(experiment, cell.setting, concurrent, seed, stop.token());
      if (!run) return run.error();
      if (stop.requested()) return {};
      cell.runs.push_back(std::move(*run));
    }
  }
  return {};
}

/// Measures one cell after the other into `cells`, and writes what there is after each. Measurements before a
/// failure or an interruption stay.
Result<void> measure_mission_cells(const MissionExperiment& experiment, std::vector<MissionCell>& cells,
                                   const std::string& folder, StopSignal& stop) {
  const auto settings = settings_of(experiment);
  for (const MissionSetting& setting : settings) {
    MissionCell& cell = cells.emplace_back(MissionCell{setting, {}, {}});
    if (cells.size() <= experiment.published.size()) cell.published = experiment.published[cells.size() - 1];
    auto measured = measure_mission_cell(
        experiment, cells, fmt::format("combination {} of {}", cells.size(), settings.size()), stop);
    if (cell.runs.empty()) cells.pop_back();
    if (!cells.empty() && !folder.empty()) {
      auto written = write_mission_bench_files(folder, experiment, cells);
      if (measured && !written) return written;
    }
    if (!measured || stop.requested()) return measured;
  }
  return {};
}

/// The experiment of a table of the paper, on the simulated rover of example 08. The paper does not say how
/// long its planners took; its figures fit a share of about 40 % of the sequential runs, as kEffort makes it.
struct PaperTable {
  const char* robot;
  const char* mission;
  const char* sweep;
  const char* published;  ///< improvement with one, two and three planners, for each value of the sweep
};
constexpr PaperTable kPaperTables[] = {
    {"table_robot.yaml", "clear_table.yaml", "boxes=1,2,3", "9.6 %,11.1 %,,13.3 %,21.3 %,,13.8 %,29.0 %,"},
    {"loaded_robot.yaml", "set_table.yaml", "persons=2,3", ",27.4 %,,,18.9 %,"},
};
constexpr const char* kEffort = "planner.effort=1.1";

/// Fills in what the table is about and is not given.
Result<MissionBenchOptions> with_table(MissionBenchOptions options) {
  if (options.table == 0) {
    if (!options.robot.empty() && !options.mission.empty()) return options;
    return fail(ErrorCode::InvalidArgument, "name the robot file and the mission file, or a table (--table)");
  }
  const PaperTable& table = kPaperTables[options.table - 1];
  MissionExperiment& experiment = options.experiment;
  if (options.robot.empty()) options.robot = table.robot;
  if (options.mission.empty()) options.mission = table.mission;
  const auto varies = [&](std::string_view name) {
    return std::ranges::any_of(options.sweeps, [&](const std::string& one) { return one.starts_with(name); });
  };
  const bool as_published = options.sweeps.empty() && options.pools.empty();
  const std::string_view sweep = table.sweep;
  if (!varies(sweep.substr(0, sweep.find('=') + 1))) options.sweeps.emplace_back(sweep);
  if (!varies("planner.effort=")) options.sweeps.emplace_back(kEffort);
  if (options.pools.empty()) options.pools.emplace_back("planner=1,2,3");
  if (experiment.seeds.empty()) experiment.seeds = {"seed", "rover.seed"};
  if (experiment.clock.empty()) experiment.clock = "rover.time";
  if (experiment.sequential_pools == 0) experiment.sequential_pools = 1;
  if (experiment.published.empty() && as_published) experiment.published = texts(table.published);
  return options;
}

Result<MissionExperiment> experiment_of(const MissionBenchOptions& given) {
  const auto filled = with_table(given);
  if (!filled) return filled.error();
  const MissionBenchOptions& options = *filled;
  MissionExperiment experiment = options.experiment;
  experiment.robot = options.robot;
  experiment.mission = options.mission;
  auto inputs = parse_inputs(options.inputs);
  if (!inputs) return inputs.error();
  experiment.inputs = std::move(*inputs);
  for (const std::string& text : options.sweeps) {
    if (auto added = add_factor(text, MissionFactor::Kind::Input, experiment.factors); !added)
      return added.error();
  }
  for (const std::string& text : options.pools) {
    if (auto added = add_factor(text, MissionFactor::Kind::PoolSize, experiment.factors); !added)
      return added.error();
  }
  return experiment;
}

int bench_mission(const MissionBenchOptions& options, const Context& context) {
  const auto wanted = experiment_of(options);
  if (!wanted) return failed(context, wanted.error());
  const MissionExperiment& experiment = *wanted;
  StopSignal stop;
  if (!options.folder.empty()) {
    if (auto made = make_bench_folder(options.folder); !made) return failed(context, made.error());
  }
  set_log_level(LogLevel::Error);
  std::vector<MissionCell> cells;
  const auto measured = measure_mission_cells(experiment, cells, options.folder, stop);
  if (!cells.empty() && !context.json()) print(mission_bench_text(experiment, cells));
  if (!measured) return failed(context, measured.error());
  if (context.json()) print_json(mission_bench_value(experiment, cells));
  if (!stop.requested()) return kDone;
  print_note("interrupted; this is what was measured until then");
  return kFailed;
}

constexpr const char* kMissionBenchHelp =
    "  segue bench mission robot.yaml mission.yaml --runs 5\n"
    "  segue bench mission table_robot.yaml clear_table.yaml --sweep boxes=1,2,3 --pool planner=1,2 \\\n"
    "    --seed seed --seed rover.seed --clock rover.time \\\n"
    "    --published '10 %,11 %,13 %,21 %,14 %,29 %' --out results\n"
    "  cd examples/08_rover && segue bench mission --table 1\n\n"
    "Runs a mission sequentially and concurrently, each time on the robot started afresh, with each\n"
    "combination of what is varied, and says what concurrency saves, what an ideal schedule of the same\n"
    "durations would save, and how long the engine was deciding: the experiments of Brunner et al.,\n"
    "Autonomous parallelization of resource-aware robotic task nodes, 2019, with any robot and mission. "
    "Close\n"
    "other programs first; no other runtime may command the robot. Ctrl-C ends it cleanly and prints what "
    "was\n"
    "measured until then.\n\n"
    "--table 1 and 2 are the paper's tables, on the simulated rover of example 08: one to three boxes are\n"
    "brought from a table, two and three persons' places are laid. Plans take as long as on the paper's\n"
    "robot, about 40 % of a sequential run (planner.effort; vary it by --sweep), with one planner and one\n"
    "after the other in sequential runs, with one to three planners in concurrent ones.\n";

}  // namespace

MissionSetting sequential_setting(const MissionExperiment& experiment, MissionSetting setting) {
  for (std::size_t i = 0; experiment.sequential_pools != 0 && i < setting.size(); ++i) {
    if (experiment.factors[i].kind == MissionFactor::Kind::PoolSize)
      setting[i] = type::Value(std::int64_t{experiment.sequential_pools});
  }
  return setting;
}

std::vector<MissionSetting> settings_of(const MissionExperiment& experiment) {
  std::vector<MissionSetting> settings(1);
  for (const MissionFactor& factor : experiment.factors) {
    std::vector<MissionSetting> longer;
    for (const MissionSetting& setting : settings) {
      for (const type::Value& value : factor.values) {
        longer.push_back(setting);
        longer.back().push_back(value);
      }
    }
    settings = std::move(longer);
  }
  return settings;
}

void add_bench_mission(Verb& bench, Context& context) {
  const auto options = std::make_shared<MissionBenchOptions>();
  MissionExperiment& experiment = options->experiment;
  Verb& verb =
      add_verb(bench, context, "mission", "compare the sequential run of a mission with its concurrent run",
               kMissionBenchHelp, [options, &context] { return bench_mission(*options, context); });
  verb.option("ROBOT", options->robot, "the robot file");
  verb.option("MISSION", options->mission, "the mission file");
  verb.option("--table N", options->table,
              "the experiment of table 1 or 2 of the paper, in examples/08_rover")
      .between(1, 2);
  verb.option("--runs N", experiment.runs, "runs in each mode, of each combination (default 5)")
      .between(1, kMostMissionRuns);
  verb.option("--input NAME=VALUE", options->inputs, "an input of the mission; may be repeated")
      .takes_one_at_a_time();
  verb.option("--sweep NAME=VALUE,...", options->sweeps,
              "an input of the mission, or TASK.PROPERTY of the robot, that is varied; may be repeated")
      .takes_one_at_a_time();
  verb.option("--pool NAME=SIZE,...", options->pools, "how many instances a pool has; may be repeated")
      .takes_one_at_a_time();
  verb.option("--sequential-pools N", experiment.sequential_pools,
              "sequential runs have N instances of each --pool (default: as many as the concurrent ones)")
      .between(1, model::kLargestPool);
  verb.flag("--any-pace", experiment.any_pace,
            fmt::format("also report where the robot's clock ran slower than {} of real time", kLeastPace));
  verb.option("--seed NAME", experiment.seeds,
              "an input or TASK.PROPERTY that is 1 in the first run, 2 in the second ...; may be repeated")
      .takes_one_at_a_time();
  verb.option("--clock TASK.PORT", experiment.clock,
              "seconds in the robot's own time, such as a simulation's");
  verb.option(
      "--published TEXT,...",
      [&experiment](const std::string& text) {
        experiment.published = texts(text);
        return Result<void>();
      },
      "figures to show beside, one for each combination, of which pools vary first");
  verb.option("--out DIR", options->folder, "also write all runs as CSV, and a chart as SVG");
  verb.option("--libraries DIR", experiment.libraries, "folders with the state machines used by the mission");
}

}  // namespace segue::cli

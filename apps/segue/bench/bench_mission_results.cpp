// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/draw/chart.hpp>

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "../output.hpp"
#include "bench_mission.hpp"
#include "paired_saving.hpp"

namespace segue::cli {

namespace {

/// Which clock a figure is of.
enum class BenchClock : std::uint8_t { Robot, Wall };

const MissionTimes* times_of(const MissionRun& run, BenchClock clock) {
  if (!run.ended_well) return nullptr;
  if (clock == BenchClock::Wall) return &run.wall;
  return run.robot ? &*run.robot : nullptr;
}

/// The runs of one cell in one mode by one clock.
struct ModeFigures {
  std::size_t runs = 0;
  std::size_t ended_well = 0;
  double median = 0;  ///< of the makespan, as the next
  double mean = 0;
  double idle = 0;        ///< share of the makespan, mean
  double planning = 0;    ///< the same of calls of pools
  double ideal = 0;       ///< of the concurrent schedule with these durations, mean
  double over_ideal = 0;  ///< how much longer than ideal, mean; 0.1 is a tenth
};

ModeFigures mission_figures(const MissionCell& cell, bool concurrent, BenchClock clock) {
  ModeFigures figures;
  std::vector<double> makespans;
  double idle = 0;
  for (const MissionRun& run : cell.runs) {
    if (run.concurrent != concurrent) continue;
    ++figures.runs;
    figures.ended_well += run.ended_well ? 1 : 0;
    const MissionTimes* times = times_of(run, clock);
    if (times == nullptr || times->makespan <= 0) continue;
    makespans.push_back(times->makespan);
    idle += run.idle / run.wall.makespan;
    figures.planning += run.planning / run.wall.makespan;
    figures.ideal += times->ideal;
    if (times->ideal > 0) figures.over_ideal += times->makespan / times->ideal - 1;
  }
  if (makespans.empty()) return figures;
  const auto count = static_cast<double>(makespans.size());
  figures.mean = std::accumulate(makespans.begin(), makespans.end(), 0.0) / count;
  figures.median = draw::median_of(makespans);
  figures.idle = idle / count;
  figures.planning /= count;
  figures.ideal /= count;
  figures.over_ideal /= count;
  return figures;
}

/// The figures of a cell by one clock.
struct CellFigures {
  ModeFigures sequential;
  ModeFigures concurrent;
  PairedSaving saved;    ///< by concurrent runs, of sequential ones with the same seed
  PairedSaving allowed;  ///< by an ideal schedule of the sequential runs' own durations
};

CellFigures mission_figures(const MissionCell& cell, BenchClock clock) {
  std::map<std::uint64_t, MeasuredPair> by_seed;
  std::vector<MeasuredPair> ideal;
  for (const MissionRun& run : cell.runs) {
    const MissionTimes* times = times_of(run, clock);
    if (times == nullptr || times->makespan <= 0) continue;
    (run.concurrent ? by_seed[run.seed].after : by_seed[run.seed].before) = times->makespan;
    if (!run.concurrent) ideal.push_back({times->makespan, times->ideal});
  }
  std::vector<MeasuredPair> pairs;
  for (const auto& [seed, pair] : by_seed) {
    if (pair.before > 0 && pair.after > 0) pairs.push_back(pair);
  }
  return {mission_figures(cell, false, clock), mission_figures(cell, true, clock), paired_saving(pairs),
          paired_saving(ideal)};
}

std::string percent(double share) {
  const double tenths = std::round(1000 * share) / 10;
  return fmt::format("{:.1f} %", tenths == 0 ? 0 : tenths);  // no -0.0
}

/// "11.2 % (9.8 to 12.6)".
std::string saving_text(const PairedSaving& saving) {
  if (saving.pairs == 0) return "-";
  if (!saving.half_width) return percent(saving.mean);
  return fmt::format("{} ({:.1f} to {:.1f})", percent(saving.mean), 100 * (saving.mean - *saving.half_width),
                     100 * (saving.mean + *saving.half_width));
}

std::string makespan_text(const ModeFigures& mode) {
  return mode.mean > 0 ? fmt::format("{:.2f} ({:.2f})", mode.median, mode.mean) : "-";
}

bool has_robot_clock(const std::vector<MissionCell>& cells) {
  return std::ranges::any_of(cells, [](const MissionCell& cell) {
    return std::ranges::any_of(cell.runs, [](const MissionRun& run) { return run.robot.has_value(); });
  });
}

std::string mission_table(const MissionExperiment& experiment, const std::vector<MissionCell>& cells,
                          BenchClock clock) {
  using Align = Table::Align;
  std::vector<Table::Column> columns;
  for (const MissionFactor& factor : experiment.factors)
    columns.push_back({factor.name, Align::Right});
  for (const char* title : {"ended well", "planning", "sequential", "concurrent", "saved (95 %)",
                            "ideal saves", "over ideal", "deciding"})
    columns.push_back({title, Align::Right});
  if (!experiment.published.empty()) columns.push_back({"published", Align::Right});
  Table table(std::move(columns));
  for (const MissionCell& cell : cells) {
    const CellFigures figures = mission_figures(cell, clock);
    std::vector<std::string> row;
    for (const type::Value& value : cell.setting)
      row.push_back(one_line(value));
    const auto& [sequential, concurrent, saved, allowed] = figures;
    row.push_back(fmt::format("{}/{}, {}/{}", sequential.ended_well, sequential.runs, concurrent.ended_well,
                              concurrent.runs));
    row.push_back(sequential.mean > 0 ? fmt::format("{:.0f} %", 100 * sequential.planning) : "-");
    row.push_back(makespan_text(sequential));
    row.push_back(makespan_text(concurrent));
    row.push_back(saving_text(saved));
    row.push_back(allowed.pairs > 0 ? percent(allowed.mean) : "-");
    row.push_back(concurrent.mean > 0 ? percent(concurrent.over_ideal) : "-");
    row.push_back(fmt::format("{}, {}",
                              sequential.mean > 0 ? fmt::format("{:.2f} %", 100 * sequential.idle) : "-",
                              concurrent.mean > 0 ? fmt::format("{:.2f} %", 100 * concurrent.idle) : "-"));
    if (!experiment.published.empty()) row.push_back(cell.published.empty() ? "-" : cell.published);
    table.add(std::move(row));
  }
  return table.text();
}

/// For people.
std::string mode_name(bool concurrent) {
  return concurrent ? "concurrent" : "sequential";
}
/// The name of the mode, as in `segue mission run --mode`.
std::string mode_key(bool concurrent) {
  return concurrent ? "concurrent" : "sequential";
}

/// "boxes 2, planner 1".
std::string setting_text(const MissionExperiment& experiment, const MissionSetting& setting,
                         std::size_t first = 0) {
  std::string text;
  for (std::size_t i = first; i < setting.size(); ++i)
    text += (text.empty() ? "" : ", ") + experiment.factors[i].name + " " + one_line(setting[i]);
  return text;
}

std::string failures_of(const MissionExperiment& experiment, const std::vector<MissionCell>& cells) {
  std::string text;
  for (const MissionCell& cell : cells) {
    for (const MissionRun& run : cell.runs) {
      if (run.ended_well) continue;
      const std::string setting = setting_text(experiment, cell.setting);
      text += fmt::format("{}{}{}, run {}: {}{}{}\n", setting, setting.empty() ? "" : ", ",
                          mode_name(run.concurrent), run.seed, run.outcome, run.error.empty() ? "" : ": ",
                          run.error);
    }
  }
  return text;
}

constexpr std::string_view kMissionFootnotes =
    "Planning: share of a sequential run in which calls of pools are under way.\n"
    "Makespans in seconds: median (mean) of the runs that ended well. Saved: mean of 1 - concurrent /\n"
    "sequential over runs with the same seed, with Student's 95 % confidence interval for pairs. Ideal\n"
    "saves: likewise, if the durations of the sequential run are scheduled concurrently in virtual\n"
    "time, with its number of instances, where deciding takes no time. Over ideal: how much longer a\n"
    "concurrent run took than its own durations in virtual time. Deciding: share of the wall time in\n"
    "which no action was under way, sequentially and concurrently.\n";

type::Value figures_value(const MissionCell& cell, BenchClock clock) {
  const CellFigures figures = mission_figures(cell, clock);
  const auto mode = [](const ModeFigures& of) {
    return type::Value::map(
        {{"median_s", of.median}, {"mean_s", of.mean}, {"ideal_s", of.ideal}, {"over_ideal", of.over_ideal}});
  };
  const auto saving = [](const PairedSaving& of) {
    auto value = type::Value::map({{"pairs", std::uint64_t{of.pairs}}, {"mean", of.mean}});
    if (of.half_width) value.as_map().set("half_width_95", *of.half_width);
    return value;
  };
  return type::Value::map({{"sequential", mode(figures.sequential)},
                           {"concurrent", mode(figures.concurrent)},
                           {"saved", saving(figures.saved)},
                           {"ideal_saves", saving(figures.allowed)}});
}

type::Value run_value(const MissionRun& run) {
  auto value = type::Value::map({{"mode", mode_key(run.concurrent)},
                                 {"seed", run.seed},
                                 {"ended_well", run.ended_well},
                                 {"outcome", run.outcome},
                                 {"makespan_s", run.wall.makespan},
                                 {"planning_s", run.planning},
                                 {"deciding_s", run.idle}});
  type::ValueMap& map = value.as_map();
  if (!run.error.empty()) map.set("error", run.error);
  if (run.ended_well) map.set("ideal_s", run.wall.ideal);
  if (run.robot) {
    map.set("robot_makespan_s", run.robot->makespan);
    map.set("robot_ideal_s", run.robot->ideal);
  }
  return value;
}

/// The text as a field of CSV (RFC 4180).
std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text)
    quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string csv_of_missions(const MissionExperiment& experiment, const std::vector<MissionCell>& cells) {
  std::string text;
  for (const MissionFactor& factor : experiment.factors)
    text += csv_field(factor.name) + ",";
  text +=
      "mode,seed,ended_well,outcome,makespan_s,ideal_s,planning_s,deciding_s,robot_makespan_s,robot_ideal_s,"
      "error\n";
  for (const MissionCell& cell : cells) {
    for (const MissionRun& run : cell.runs) {
      for (const type::Value& value : cell.setting)
        text += csv_field(one_line(value)) + ",";
      text +=
          fmt::format("{},{},{},{},{:.6f},{},{:.6f},{:.6f},", mode_key(run.concurrent), run.seed,
                      run.ended_well, csv_field(run.outcome), run.wall.makespan,
                      run.ended_well ? fmt::format("{:.6f}", run.wall.ideal) : "", run.planning, run.idle);
      text += run.robot ? fmt::format("{:.6f},{:.6f},", run.robot->makespan, run.robot->ideal) : ",,";
      text += csv_field(run.error) + "\n";
    }
  }
  return text;
}

/// The makespans of the cell's timed runs in that mode.
std::vector<double> makespans_of(const MissionCell& cell, bool concurrent, BenchClock clock) {
  std::vector<double> makespans;
  for (const MissionRun& run : cell.runs) {
    const MissionTimes* times = times_of(run, clock);
    if (run.concurrent == concurrent && times != nullptr && times->makespan > 0)
      makespans.push_back(times->makespan);
  }
  return makespans;
}

/// Makespans over the first factor, whose values count as 1, 2, ... where one is not a number; a line for
/// each mode and setting of the others.
draw::Chart chart_of_missions(const MissionExperiment& experiment, const std::vector<MissionCell>& cells) {
  const MissionFactor& first = experiment.factors.front();
  const BenchClock clock = has_robot_clock(cells) ? BenchClock::Robot : BenchClock::Wall;
  const bool by_number = std::ranges::all_of(first.values, &type::Value::is_number);
  draw::Chart chart{
      "makespan" + std::string(clock == BenchClock::Robot ? " in the robot's time" : ""), first.name, {}};
  for (const bool concurrent : {false, true}) {
    for (const MissionCell& cell : cells) {
      auto makespans = makespans_of(cell, concurrent, clock);
      if (makespans.empty()) continue;
      const std::string others = setting_text(experiment, cell.setting, 1);
      const std::string name = mode_name(concurrent) + (others.empty() ? "" : ", " + others);
      auto line = std::ranges::find(chart.lines, name, &draw::Chart::Line::name);
      if (line == chart.lines.end()) line = chart.lines.insert(line, {name, {}});
      const auto place = std::ranges::find(first.values, cell.setting.front()) - first.values.begin();
      line->points.push_back({by_number ? cell.setting.front().as_double() : static_cast<double>(place + 1),
                              std::move(makespans)});
    }
  }
  for (draw::Chart::Line& line : chart.lines)
    std::ranges::sort(line.points, {}, &draw::Chart::Point::x);
  return chart;
}

}  // namespace

std::string mission_bench_text(const MissionExperiment& experiment, const std::vector<MissionCell>& cells) {
  std::string text;
  if (has_robot_clock(cells))
    text += "In the robot's time (" + experiment.clock + "):\n\n" +
            mission_table(experiment, cells, BenchClock::Robot) + "\n";
  text += "In wall time:\n\n" + mission_table(experiment, cells, BenchClock::Wall) + "\n";
  text += kMissionFootnotes;
  if (const std::string failures = failures_of(experiment, cells); !failures.empty())
    text += "\nRuns that did not end well:\n" + failures;
  return text;
}

type::Value mission_bench_value(const MissionExperiment& experiment, const std::vector<MissionCell>& cells) {
  type::Value::List list;
  for (const MissionCell& cell : cells) {
    type::ValueMap setting;
    for (std::size_t i = 0; i < cell.setting.size(); ++i)
      setting.set(experiment.factors[i].name, cell.setting[i]);
    type::Value::List runs;
    for (const MissionRun& run : cell.runs)
      runs.push_back(run_value(run));
    type::ValueMap map;
    map.set("setting", std::move(setting));
    map.set("wall", figures_value(cell, BenchClock::Wall));
    if (has_robot_clock({cell})) map.set("robot", figures_value(cell, BenchClock::Robot));
    if (!cell.published.empty()) map.set("published", cell.published);
    map.set("runs", std::move(runs));
    list.emplace_back(std::move(map));
  }
  return type::Value::map({{"cells", std::move(list)}});
}

Result<void> write_mission_bench_files(const std::filesystem::path& folder,
                                       const MissionExperiment& experiment,
                                       const std::vector<MissionCell>& cells) {
  const std::string stem = folder / experiment.mission.stem();
  if (auto csv = write_file(stem + ".csv", csv_of_missions(experiment, cells)); !csv) return csv;
  if (experiment.factors.empty()) return {};
  const draw::Chart chart = chart_of_missions(experiment, cells);
  return chart.lines.empty() ? Result<void>() : write_file(stem + ".svg", to_svg(chart));
}

}  // namespace segue::cli

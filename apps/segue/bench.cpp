// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/base/log.hpp>
#include <segue/base/text.hpp>

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <memory>

#include <segue/draw/chart.hpp>
#include "bench_experiment.hpp"
#include "bench_robot.hpp"
#include "command.hpp"
#include "output.hpp"
#include "stop_signal.hpp"

namespace segue::cli {

namespace {

namespace fs = std::filesystem;

struct BenchOptions {
  std::string folder = "segue-bench";
  std::string order = std::string(to_string(model::Order::Seamless));
  std::size_t repeat = 5;
  bool quick = false;
};

struct BenchPlan {
  std::vector<std::size_t> in_process = {1, 5, 10, 25, 50, 100, 250};
  std::vector<std::size_t> in_processes = {1, 5, 10, 25, 50};
  std::size_t repeat = 5;
  model::Order order = model::Order::Seamless;
};

BenchPlan plan_for(const BenchOptions& options) {
  BenchPlan plan;
  plan.repeat = options.repeat;
  if (options.order == to_string(model::Order::Paper)) plan.order = model::Order::Paper;
  if (!options.quick) return plan;
  plan.in_process = {1, 2, 4};
  plan.in_processes = {1, 2};
  plan.repeat = std::min<std::size_t>(options.repeat, 2);
  return plan;
}

const std::vector<std::size_t>& sizes_of(const BenchPlan& plan, Placement placement) {
  return placement == Placement::OneProcess ? plan.in_process : plan.in_processes;
}

constexpr std::array kPlacements = {Placement::OneProcess, Placement::ProcessEach};

/// All measurements, in the order in which they were made.
class BenchResults {
 public:
  void add(const Measurement& measurement) {
    times_[{measurement.experiment, measurement.placement, measurement.relays}].push_back(
        measurement.seconds);
  }
  [[nodiscard]] bool empty() const { return times_.empty(); }
  [[nodiscard]] std::vector<std::size_t> sizes(const std::string& experiment, Placement placement) const {
    std::vector<std::size_t> sizes;
    for (const auto& [key, times] : times_) {
      if (key.experiment == experiment && key.placement == placement) sizes.push_back(key.relays);
    }
    return sizes;
  }
  [[nodiscard]] const std::vector<double>& times(const std::string& experiment, Placement placement,
                                                 std::size_t relays) const {
    return times_.at({experiment, placement, relays});
  }

 private:
  struct Key {
    std::string experiment;
    Placement placement;
    std::size_t relays;
    auto operator<=>(const Key&) const = default;
  };
  std::map<Key, std::vector<double>> times_;
};

draw::Chart chart_of(const Experiment& experiment, const BenchResults& results) {
  draw::Chart chart{experiment.name + ": " + experiment.title, "relays", {}};
  for (const Placement placement : kPlacements) {
    draw::Chart::Line line{to_string(placement), {}};
    for (const std::size_t relays : results.sizes(experiment.name, placement))
      line.points.push_back({static_cast<double>(relays), results.times(experiment.name, placement, relays)});
    chart.lines.push_back(std::move(line));
  }
  return chart;
}

std::string csv_of(const Experiment& experiment, const BenchResults& results) {
  std::string text = "placement,relays,repetition,milliseconds\n";
  for (const Placement placement : kPlacements) {
    for (const std::size_t relays : results.sizes(experiment.name, placement)) {
      std::size_t repetition = 0;
      for (const double seconds : results.times(experiment.name, placement, relays))
        text += fmt::format("{},{},{},{:.4f}\n", to_string(placement), relays, ++repetition, seconds * 1e3);
    }
  }
  return text;
}

/// "E2.3 worst" as "E2.3_worst".
std::string file_stem(const Experiment& experiment) {
  std::string name = experiment.name;
  std::ranges::replace(name, ' ', '_');
  return name;
}

Result<void> write_results(const fs::path& folder, const BenchResults& results) {
  for (const Experiment& experiment : experiments()) {
    const fs::path stem = folder / file_stem(experiment);
    const auto csv = write_file(stem.string() + ".csv", csv_of(experiment, results));
    if (!csv) return csv;
    const auto svg = write_file(stem.string() + ".svg", to_svg(chart_of(experiment, results)));
    if (!svg) return svg;
  }
  return {};
}

/// The largest chain of each series.
Table summary_of(const BenchResults& results) {
  using Align = Table::Align;
  Table table({{"experiment"},
               {"placement"},
               {"relays", Align::Right},
               {"median", Align::Right},
               {"least", Align::Right},
               {"most", Align::Right}});
  for (const Experiment& experiment : experiments()) {
    for (const Placement placement : kPlacements) {
      const auto sizes = results.sizes(experiment.name, placement);
      if (sizes.empty()) continue;
      const auto& times = results.times(experiment.name, placement, sizes.back());
      const auto [least, most] = std::ranges::minmax(times);
      table.add({experiment.name, to_string(placement), std::to_string(sizes.back()),
                 format_seconds(draw::median_of(times)), format_seconds(least), format_seconds(most)});
    }
  }
  return table;
}

type::Value json_of(const BenchResults& results) {
  type::Value::List series;
  for (const Experiment& experiment : experiments()) {
    for (const Placement placement : kPlacements) {
      type::Value::List points;
      for (const std::size_t relays : results.sizes(experiment.name, placement)) {
        type::Value::List times;
        for (const double seconds : results.times(experiment.name, placement, relays))
          times.emplace_back(seconds);
        points.push_back(
            type::Value::map({{"relays", std::uint64_t{relays}}, {"seconds", std::move(times)}}));
      }
      series.push_back(type::Value::map({{"experiment", experiment.name},
                                         {"title", experiment.title},
                                         {"placement", to_string(placement)},
                                         {"points", std::move(points)}}));
    }
  }
  return type::Value::map({{"series", std::move(series)}});
}

/// Measures one placement, with a robot of its own.
Result<void> measure(Placement placement, const BenchPlan& plan, BenchResults& results, StopSignal& stop) {
  auto robot = make_bench_robot(placement, plan.order);
  if (!robot) return robot.error();
  Progress progress;
  const auto report = [&](const Measurement& measurement) {
    results.add(measurement);
    progress.show(fmt::format("{}: {} relays, {}: {}", to_string(placement), measurement.relays,
                              measurement.experiment, format_seconds(measurement.seconds)));
    return !stop.requested();
  };
  return run_experiments(**robot, placement, sizes_of(plan, placement), plan.repeat, report);
}

int run_bench(const BenchOptions& options, const Context& context) {
  StopSignal stop;
  std::error_code failed_to_make;
  fs::create_directories(options.folder, failed_to_make);
  if (failed_to_make) {
    return failed(context, fail(ErrorCode::IoError, "cannot create the folder " + quote(options.folder) +
                                                        ": " + failed_to_make.message()));
  }
  set_log_level(LogLevel::Error);
  const BenchPlan plan = plan_for(options);
  BenchResults results;
  Result<void> measured;
  for (const Placement placement : kPlacements) {
    if (measured && !stop.requested()) measured = measure(placement, plan, results, stop);
  }
  const auto written = write_results(options.folder, results);
  if (!measured) return failed(context, measured.error());
  if (!written) return failed(context, written.error());
  if (context.json()) {
    print_json(json_of(results));
  } else {
    print(summary_of(results).text());
    print_line(fmt::format("all series as CSV and SVG: {}", (fs::path(options.folder) / "").string()));
  }
  if (!stop.requested()) return kDone;
  print_note("interrupted; the results so far have been written");
  return kFailed;
}

}  // namespace

void add_bench(Verb& app, Context& context) {
  const auto options = std::make_shared<BenchOptions>();
  Verb& verb = add_verb(
      app, context, "bench", "measure how fast this computer switches controllers, as CSV and SVG",
      "  segue bench --quick               # takes some seconds, to check that everything works\n"
      "  segue bench --out results\n\n"
      "Chains of producer, relays and consumer are started (E1.1) and removed (E1.2). In running chains, "
      "one\n"
      "relay (E2.1), all relays (E2.2) or half of them (E2.3: adjacent ones, the best case; every second "
      "one,\n"
      "the worst; and the longest gap between samples) are exchanged. Everything is measured in one process\n"
      "and with one process per task. Close other programs first. Ctrl-C ends it cleanly: no process is "
      "left.",
      [options, &context] { return run_bench(*options, context); });
  verb.option("--out DIR", options->folder, "the output folder (default segue-bench)");
  verb.option("--repeat N", options->repeat, "number of repetitions (default 5)").between(1, 1000);
  add_order_option(verb, options->order);
  verb.flag("--quick", options->quick, "short chains and two repetitions only");
}

}  // namespace segue::cli

// SPDX-License-Identifier: Apache-2.0
#include "bench_results.hpp"

#include <segue/base/file.hpp>
#include <segue/draw/chart.hpp>

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "../output.hpp"

namespace segue::cli {

namespace {

namespace fs = std::filesystem;

struct Spread {
  double median = 0;
  double most_of_99_percent = 0;
  double least = 0;
  double most = 0;
};

/// The 99th percentile is the nearest rank: the largest value where there are at most a hundred.
Spread spread_of(std::vector<double> values) {
  std::ranges::sort(values);
  const auto rank = static_cast<std::size_t>(std::ceil(0.99 * static_cast<double>(values.size())));
  return {draw::median_of(values), values[rank - 1], values.front(), values.back()};
}

std::optional<double> median_of(const std::vector<double>& floor) {
  if (floor.empty()) return std::nullopt;
  return draw::median_of(floor);
}

/// "1.62", and "1.62, 0.4" for two floors; "-" where there is none.
std::string ratios_of(double median, const BenchFloor& floor) {
  std::string text;
  for (const auto* one : {&floor.one_processor, &floor.across}) {
    const auto least = median_of(*one);
    if (!least || *least <= 0) continue;
    text += (text.empty() ? "" : ", ") + fmt::format("{:.2f}", median / *least);
  }
  return text.empty() ? "-" : text;
}

std::string floor_text(const std::vector<double>& floor) {
  const auto median = median_of(floor);
  return median ? format_seconds(*median) : "-";
}

bool is_latency(const BenchResults& results) {
  return results.experiment->name.starts_with("E1.");
}

Table empty_table(const BenchResults& results) {
  using Align = Table::Align;
  std::vector<Table::Column> columns = {{""}, {"transport"}, {"relays", Align::Right}};
  if (results.experiment->by == "bytes") columns.push_back({"bytes", Align::Right});
  for (const char* title : {"count", "median", "99 %", "least", "most"})
    columns.push_back({title, Align::Right});
  if (is_latency(results)) columns.push_back({"a hop", Align::Right});
  columns.push_back({"floor: one core", Align::Right});
  columns.push_back({"two cores", Align::Right});
  columns.push_back({"ratios", Align::Right});
  columns.push_back({"published"});
  return Table(std::move(columns));
}

std::vector<std::string> cells_of(const BenchRow& row, const BenchResults& results) {
  const Spread spread = spread_of(row.seconds);
  std::vector<std::string> cells = {row.what, to_string(row.transport), std::to_string(row.relays)};
  if (results.experiment->by == "bytes") cells.push_back(std::to_string(row.bytes));
  cells.push_back(std::to_string(row.seconds.size()));
  for (const double value : {spread.median, spread.most_of_99_percent, spread.least, spread.most})
    cells.push_back(format_seconds(value));
  if (is_latency(results))
    cells.push_back(format_seconds(spread.median / static_cast<double>(row.relays + 1)));
  cells.push_back(floor_text(row.floor.one_processor));
  cells.push_back(floor_text(row.floor.across));
  cells.push_back(ratios_of(spread.median, row.floor));
  cells.push_back(row.published.empty() ? "-" : row.published);
  return cells;
}

constexpr std::string_view kBenchFootnotes =
    "local: all tasks in one process, a thread each; shm: a process for each relay, samples in shared "
    "memory;\n"
    "remote: the same with another host. The floor is what the operating system needs for the same job, all\n"
    "on one processor, and neighbours on two; ratios: of the medians, to both. Published figures are of "
    "Orocos\n"
    "RTT with CORBA on other computers, so compare ratios of one run instead. Not measured: CORBA (Segue "
    "does\n"
    "not use it).\n";

type::Value list_of(const std::vector<double>& values) {
  type::Value::List list;
  for (const double value : values)
    list.emplace_back(value);
  return list;
}

type::Value row_value(const BenchRow& row) {
  const Spread spread = spread_of(row.seconds);
  auto value = type::Value::map({{"what", row.what},
                                 {"transport", to_string(row.transport)},
                                 {"relays", std::uint64_t{row.relays}},
                                 {"median_s", spread.median},
                                 {"p99_s", spread.most_of_99_percent},
                                 {"least_s", spread.least},
                                 {"most_s", spread.most},
                                 {"seconds", list_of(row.seconds)}});
  type::ValueMap& map = value.as_map();
  map.set("bytes", std::uint64_t{row.bytes});
  if (const auto floor = median_of(row.floor.one_processor)) map.set("floor_s", *floor);
  if (const auto floor = median_of(row.floor.across)) map.set("floor_across_s", *floor);
  if (!row.published.empty()) map.set("published", row.published);
  return value;
}

type::ValueMap experiment_value(const BenchExperiment& experiment) {
  type::ValueMap map;
  map.set("experiment", experiment.name);
  map.set("title", experiment.title);
  map.set("measured", experiment.measured);
  map.set("published", experiment.published);
  return map;
}

std::string csv_of(const BenchResults& results) {
  std::string text = "what,transport,relays,bytes,repetition,milliseconds\n";
  for (const BenchRow& row : results.rows) {
    std::size_t repetition = 0;
    for (const double seconds : row.seconds) {
      text += fmt::format("{},{},{},{},{},{:.6f}\n", row.what, to_string(row.transport), row.relays,
                          row.bytes, ++repetition, seconds * 1e3);
    }
  }
  return text;
}

/// One line for each thing measured on each transport. Sizes differ by powers, so their logarithm is drawn.
draw::Chart chart_of(const BenchResults& results) {
  const bool by_size = results.experiment->by == "bytes";
  draw::Chart chart{fmt::format("{}: {}", results.experiment->name, results.experiment->title),
                    by_size ? "log10 of the bytes" : "relays",
                    {}};
  for (const BenchRow& row : results.rows) {
    const std::string name = row.what + ", " + to_string(row.transport);
    auto line = std::ranges::find(chart.lines, name, &draw::Chart::Line::name);
    if (line == chart.lines.end()) line = chart.lines.insert(line, {name, {}});
    const double x = by_size ? std::log10(static_cast<double>(row.bytes)) : static_cast<double>(row.relays);
    line->points.push_back({x, row.seconds});
  }
  for (draw::Chart::Line& line : chart.lines)
    std::ranges::sort(line.points, {}, &draw::Chart::Point::x);
  return chart;
}

}  // namespace

std::string bench_list_text() {
  Table table({{"experiment"}, {"measures"}, {"published"}});
  for (const BenchExperiment& experiment : bench_experiments())
    table.add(
        {std::string(experiment.name), std::string(experiment.title), std::string(experiment.published)});
  return table.text();
}

type::Value bench_list_value() {
  type::Value::List list;
  for (const BenchExperiment& experiment : bench_experiments())
    list.emplace_back(experiment_value(experiment));
  return type::Value::map({{"experiments", std::move(list)}});
}

std::string bench_text(const BenchResults& results) {
  Table table = empty_table(results);
  for (const BenchRow& row : results.rows)
    table.add(cells_of(row, results));
  const BenchExperiment& experiment = *results.experiment;
  return fmt::format("{}: {}\n\n{}\n{}\nPublished: {}.\n{}", experiment.name, experiment.title, table.text(),
                     experiment.measured, experiment.published, kBenchFootnotes);
}

type::Value bench_value(const BenchResults& results) {
  type::ValueMap map = experiment_value(*results.experiment);
  type::Value::List rows;
  for (const BenchRow& row : results.rows)
    rows.push_back(row_value(row));
  map.set("rows", std::move(rows));
  type::Value::List failures;
  for (const std::string& failure : results.failures)
    failures.emplace_back(failure);
  map.set("failures", std::move(failures));
  return map;
}

Result<void> write_bench_files(const fs::path& folder, const BenchResults& results) {
  const std::string stem = folder / results.experiment->name;
  if (auto csv = write_file(stem + ".csv", csv_of(results)); !csv) return csv;
  if (results.experiment->by.empty() || results.rows.empty()) return {};
  return write_file(stem + ".svg", to_svg(chart_of(results)));
}

}  // namespace segue::cli

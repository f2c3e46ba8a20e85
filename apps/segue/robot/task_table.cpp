// SPDX-License-Identifier: Apache-2.0
#include "task_table.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "../output.hpp"

namespace segue::cli {

namespace {

using type::Value;

/// The state, with the sub-state if there is one.
std::string state_cell(const Value& task) {
  if (const Value* unknown = task.find("unknown");
      unknown != nullptr && unknown->is_bool() && unknown->as_bool()) {
    return coloured(Colour::Red, "unknown");
  }
  const std::string state = printable_at(task, "state");
  const std::string name = printable_at(task, "state_name");
  const bool is_error = state == "run_time_error" || state == "exception" || state == "fatal";
  const Colour colour = is_error ? Colour::Red : state == "running" ? Colour::Green : Colour::Yellow;
  const std::string text = name.empty() || name == state ? state : fmt::format("{} ({})", state, name);
  return coloured(colour, text);
}

std::string micros(const Value& task, std::string_view key) {
  const double value = number_at(task, key);
  return value > 0 ? format_seconds(value * 1e-6) : std::string("-");
}

/// The process in which it runs, with the host unless it is the local one.
std::string process_cell(const Value& task) {
  const std::string process = printable_at(task, "process");
  const std::string host = printable_at(task, "host");
  const bool here = host.empty() || host == "localhost" || process.empty();
  return process.empty() ? "-" : here ? process : fmt::format("{}/{}", host, process);
}

bool has_processes(const Value::List& tasks) {
  return std::any_of(tasks.begin(), tasks.end(),
                     [](const Value& task) { return !printable_at(task, "process").empty(); });
}

std::vector<std::string> task_cells(const Value& task, bool with_process, bool with_cpu) {
  const Value* stand_in = task.find("stand_in");
  const bool is_stand_in = stand_in != nullptr && stand_in->is_bool() && stand_in->as_bool();
  std::vector<std::string> row = {
      printable_at(task, "id"),   printable_at(task, "component") + (is_stand_in ? " (stand-in)" : ""),
      state_cell(task),           fmt::format("{}", number_at(task, "cycles")),
      micros(task, "cycle_us"),   micros(task, "worst_us"),
      micros(task, "latency_us"), fmt::format("{}", number_at(task, "missed"))};
  if (with_process) {
    row.insert(row.begin() + 3, {process_cell(task), fmt::format("{}", number_at(task, "pid"))});
  }
  if (with_cpu) row.push_back(micros(task, "cpu_us"));
  return row;
}

/// Errors are shown below the table, because they are longer than any cell.
std::string errors_text(const Value::List& tasks) {
  std::string text;
  for (const Value& task : tasks) {
    const std::string error = printable_at(task, "error");
    if (!error.empty())
      text += fmt::format("{} {}\n", coloured(Colour::Red, printable_at(task, "id") + ':'), error);
  }
  return text;
}

}  // namespace

std::string task_table(const Value& status, bool with_cpu) {
  using Align = Table::Align;
  const auto& tasks = list_at(status, "tasks");
  std::vector<Table::Column> columns = {{"TASK"},
                                        {"COMPONENT"},
                                        {"STATE"},
                                        {"CYCLES", Align::Right},
                                        {"MEAN", Align::Right},
                                        {"WORST", Align::Right},
                                        {"LATENCY", Align::Right},
                                        {"MISSED", Align::Right}};
  const bool with_process = has_processes(tasks);
  if (with_process) columns.insert(columns.begin() + 3, {{"PROCESS"}, {"PID", Align::Right}});
  if (with_cpu) columns.push_back({"CPU", Align::Right});
  Table table(std::move(columns));
  for (const Value& task : tasks)
    table.add(task_cells(task, with_process, with_cpu));
  return table.text() + errors_text(tasks);
}

std::string use_table(const Value::List& tasks, std::size_t columns,
                      const std::function<std::string(const std::string& task)>& processor_share) {
  using Align = Table::Align;
  constexpr std::size_t kWithProcess = 100;
  constexpr std::size_t kWithComponent = 130;
  const bool with_process = columns >= kWithProcess && has_processes(tasks);
  const bool with_component = columns >= kWithComponent;
  std::vector<Table::Column> titles = {{"TASK"},
                                       {"STATE"},
                                       {"CPU", Align::Right},
                                       {"MEAN", Align::Right},
                                       {"WORST", Align::Right},
                                       {"LATENCY", Align::Right},
                                       {"MISSED", Align::Right}};
  if (with_process) titles.push_back({"PROCESS"});
  if (with_component) titles.push_back({"COMPONENT"});
  Table table(std::move(titles));
  for (const Value& task : tasks) {
    const std::string id = printable_at(task, "id");
    std::vector<std::string> row = {id,
                                    state_cell(task),
                                    processor_share(id),
                                    micros(task, "cycle_us"),
                                    micros(task, "worst_us"),
                                    micros(task, "latency_us"),
                                    fmt::format("{}", number_at(task, "missed"))};
    if (with_process) row.push_back(process_cell(task));
    if (with_component) row.push_back(printable_at(task, "component"));
    table.add(std::move(row));
  }
  return table.text(columns);
}

}  // namespace segue::cli

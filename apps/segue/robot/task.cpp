// SPDX-License-Identifier: Apache-2.0
#include <segue/type/yaml.hpp>

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "../connection.hpp"

namespace segue::cli {

namespace {

using type::Value;

std::string ports_text(const Value& task) {
  Table table({{"PORT"}, {"DIRECTION"}, {"TYPE"}, {"DESCRIPTION"}});
  for (const Value& port : list_at(task, "ports")) {
    table.add({printable_at(port, "name"), printable_at(port, "direction"), printable_at(port, "type"),
               printable_at(port, "doc")});
  }
  return list_at(task, "ports").empty() ? std::string() : '\n' + table.text();
}

std::string operations_text(const Value& task) {
  Table table({{"OPERATION"}, {"RESULT"}, {"DESCRIPTION"}});
  for (const Value& operation : list_at(task, "operations")) {
    std::string arguments;
    for (const Value& argument : list_at(operation, "arguments")) {
      arguments += (arguments.empty() ? "" : ", ") + printable_at(argument, "name") + ": " +
                   printable_at(argument, "type");
    }
    const std::string result = printable_at(operation, "result");
    table.add({fmt::format("{}({})", printable_at(operation, "name"), arguments),
               result.empty() ? "-" : result, printable_at(operation, "doc")});
  }
  return list_at(task, "operations").empty() ? std::string() : '\n' + table.text();
}

/// ", 99 % within 3.1 us".
std::string quantile_text(const Value& task, std::string_view what) {
  const Value* histograms = task.find("histograms");
  const Value* histogram = histograms == nullptr ? nullptr : histograms->find(what);
  if (histogram == nullptr) return {};
  return ", 99 % within " + format_seconds(number_at(*histogram, "p99_us") * 1e-6);
}

std::string timing_text(const Value& task) {
  const Value* timing = task.find("timing");
  if (timing == nullptr || number_at(*timing, "cycles") == 0) return {};
  const auto micros = [&](std::string_view key) { return format_seconds(number_at(*timing, key) * 1e-6); };
  return fmt::format(
      "cycles {}, missed {}; update mean {}{}, worst {}; latency mean {}{}, worst {}; cpu {}\n",
      number_at(*timing, "cycles"), number_at(*timing, "missed"), micros("mean_us"),
      quantile_text(task, "updates"), micros("worst_us"), micros("latency_mean_us"),
      quantile_text(task, "latencies"), micros("latency_worst_us"), micros("cpu_us"));
}

/// Counts by duration: of updates, and of the times that they began after they should have. Bars are as long
/// as counts have digits, so that the few slow ones are seen.
std::string histograms_text(const Value& task) {
  const Value* histograms = task.find("histograms");
  if (histograms == nullptr) return {};
  struct Row {
    double updates = 0;
    double latencies = 0;
  };
  std::map<double, Row> rows;
  const auto add = [&](std::string_view what, double Row::*count) {
    const Value* histogram = histograms->find(what);
    if (histogram == nullptr) return;
    for (const Value& bin : list_at(*histogram, "bins"))
      rows[number_at(bin, "from_us")].*count = number_at(bin, "count");
  };
  add("updates", &Row::updates);
  add("latencies", &Row::latencies);
  if (rows.empty()) return {};
  constexpr auto kRight = Table::Align::Right;
  Table table({{"FROM", kRight}, {"UPDATES", kRight}, {""}, {"LATENCIES", kRight}, {""}});
  const auto bar = [](double count) {
    constexpr double kPerDigit = 3;
    return count > 0 ? std::string(static_cast<std::size_t>(1 + kPerDigit * std::log10(count)), '#') : "";
  };
  const auto number = [](double count) { return count > 0 ? fmt::format("{}", count) : std::string("-"); };
  for (const auto& [from, row] : rows) {
    table.add({from > 0 ? format_seconds(from * 1e-6) : std::string("0"), number(row.updates),
               bar(row.updates), number(row.latencies), bar(row.latencies)});
  }
  return '\n' + table.text();
}

/// "name: value"; a value that does not fit on the line is indented below.
std::string property_text(const std::string& name, const Value& value) {
  const std::string text = value.is_string() ? '\'' + readable(value) + '\'' : readable(value);
  if (text.find('\n') == std::string::npos) return fmt::format("  {}: {}\n", name, text);
  std::string lines = fmt::format("  {}:\n    ", name);
  for (const char c : text)
    lines += c == '\n' ? std::string("\n    ") : std::string(1, c);
  return lines + '\n';
}

std::string properties_text(const Value& task) {
  const Value* properties = task.find("properties");
  if (properties == nullptr || !properties->is_map() || properties->as_map().empty()) return {};
  std::string text = '\n' + coloured(Colour::Bold, "PROPERTIES") + '\n';
  for (const auto& [name, value] : properties->as_map())
    text += property_text(name, value);
  return text;
}

/// The newest lines, oldest first.
std::string log_text(const Value& task) {
  constexpr std::size_t kShownLines = 20;
  const auto& lines = list_at(task, "log");
  if (lines.empty()) return {};
  std::string text = '\n' + coloured(Colour::Bold, "LOG") + '\n';
  for (std::size_t at = lines.size() - std::min(lines.size(), kShownLines); at < lines.size(); ++at) {
    text += fmt::format("  {} {}: {}\n", printable_at(lines[at], "time"), printable_at(lines[at], "level"),
                        printable_at(lines[at], "message"));
  }
  return text;
}

int show_task(control::RobotService& robot, const std::string& id, const Context& context) {
  const auto task = robot.task(id);
  if (!task) return failed(context, task.error());
  if (context.json()) {
    print_json(*task);
    return kDone;
  }
  print(fmt::format("{}: {}, {}\n", coloured(Colour::Bold, printable_at(*task, "id")),
                    printable_at(*task, "component"), printable_at(*task, "state_name")));
  const std::string error = printable_at(*task, "error");
  if (!error.empty()) print(coloured(Colour::Red, "error: ") + error + '\n');
  print(timing_text(*task) + histograms_text(*task) + ports_text(*task) + properties_text(*task) +
        operations_text(*task) + log_text(*task));
  return kDone;
}

}  // namespace

void add_task(Verb& app, Context& context) {
  const auto id = std::make_shared<std::string>();
  Verb& verb =
      add_verb(app, context, "task", "show a task: state, ports, properties, operations, timing, log",
               "  segue task drive", [id, &context] {
                 return with_robot(
                     context, [&](control::RobotService& robot) { return show_task(robot, *id, context); });
               });
  verb.option("TASK", *id, "the task's id").required();
  add_robot_option(verb, context);
}

}  // namespace segue::cli

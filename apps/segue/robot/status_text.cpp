// SPDX-License-Identifier: Apache-2.0
#include "status_text.hpp"

#include <segue/base/text.hpp>

#include <fmt/core.h>

#include <sstream>

#include "../connection.hpp"
#include "health_text.hpp"

namespace segue::cli {

namespace {

using type::Value;

/// The range of a pool's size, and who waits for an instance; empty: it has no range, and nobody does.
std::string demand_text(const Value& pool) {
  const auto least = number_at(pool, "least");
  const auto most = number_at(pool, "most");
  const auto waiting = number_at(pool, "waiting");
  const std::string held_back = printable_at(pool, "held_back");
  std::string text;
  if (least != most) text += fmt::format(", {} to {} on demand", least, most);
  if (waiting > 0) text += fmt::format("; {} waiting", waiting);
  if (!held_back.empty()) text += ": " + held_back;
  return text;
}

/// How many instances of pools are ready, and why others are not.
std::string pools_text(const Value& status) {
  std::string text;
  for (const Value& pool : list_at(status, "pools")) {
    text += fmt::format("pool {}: {} of {} ready{}\n", printable_at(pool, "pool"), number_at(pool, "ready"),
                        number_at(pool, "size"), demand_text(pool));
    for (const Value& one : list_at(pool, "instances")) {
      const std::string reason = printable_at(one, "reason");
      if (!reason.empty()) {
        text += coloured(Colour::Red, printable_at(one, "task") + ": ") + printable(reason) + '\n';
      }
    }
  }
  return text;
}

/// The holder of the lease, as a line.
std::string commander_text(const Value& status) {
  const std::string who = printable_at(status, "commanded_by");
  return who.empty() ? who : fmt::format("commanded by: {}\n", printable(who));
}

/// The loss of the robot to another runtime, as text; empty: it is not lost.
std::string loss_text(const Value& status) {
  std::string why = printable_at(status, "lost");
  if (why.empty()) return why;
  return coloured(Colour::Red, "lost: " + printable(why)) + "\nonly `segue run --take-over` gets it back\n";
}

/// The halt of the robot since it was commanded last, and a stop until it is released, as text; empty:
/// neither.
std::string halt_text(const Value& status) {
  std::string text;
  if (const Value* halt = status.find("halt"); halt != nullptr && halt->is_map()) {
    const std::string state = printable_at(*halt, "state");
    const std::string why = printable_at(*halt, "why");
    text +=
        fmt::format("halted by {}{}: {}\n", printable_at(*halt, "who"), why.empty() ? "" : " (" + why + ")",
                    state == "halting"   ? "on its way to rest"
                    : state == "at_rest" ? "at rest"
                                         : "not at rest in time: " + printable_at(*halt, "trouble"));
  }
  if (const std::string who = printable_at(status, "stopped_by"); !who.empty())
    text += fmt::format("stopped by {} until `segue stop --release`\n", who);
  return text.empty() ? text : coloured(Colour::Red, printable(text));
}

/// The differences between the robot's files and the network that runs; empty if it runs what was loaded and
/// the files have not changed since.
std::string files_text(const Value& status) {
  const std::string controller = printable_at(status, "controller");
  const std::string version = printable_at(status, "version");
  const Value* loaded = status.find("loaded_version");
  std::string text;
  if (!controller.empty() && (loaded == nullptr || loaded->is_null())) {
    text +=
        fmt::format("'{}' is none of the robot's controllers; it runs until the next switch\n", controller);
  } else if (loaded != nullptr && !version.empty() && printable_at(status, "loaded_version") != version) {
    text += fmt::format("'{}' runs in version {}; version {} is loaded\n", controller, version,
                        printable_at(status, "loaded_version"));
  }
  for (const Value& change : list_at(status, "changed_files"))
    text += fmt::format("{} since it was loaded: {}\n", printable_at(change, "change"),
                        printable_at(change, "file"));
  if (!list_at(status, "changed_files").empty())
    text += "`segue plan` shows what that changes, `segue apply` does it\n";
  return text.empty() ? text : coloured(Colour::Yellow, printable(text));
}

std::string other_controllers(const Value& status) {
  auto names = names_at(status, "controllers");
  std::erase(names, printable_at(status, "controller"));
  return names.empty() ? std::string() : fmt::format("can switch to: {}\n", printable(listed(names)));
}

std::string optional_micros(const Value& host, std::string_view key) {
  const Value* value = host.find(key);
  return value == nullptr || !value->is_number() ? "-" : format_seconds(value->as_double() * 1e-6);
}

/// The computers of a robot that has several.
std::string hosts_text(const Value& status) {
  Table table({{"HOST"},
               {"ADDRESS"},
               {"STATE"},
               {"FOR", Table::Align::Right},
               {"ROUND TRIP", Table::Align::Right},
               {"CLOCK AHEAD", Table::Align::Right}});
  for (const Value& host : list_at(status, "hosts")) {
    const Value* reachable = host.find("reachable");
    const bool up = reachable != nullptr && reachable->is_bool() && reachable->as_bool();
    const std::string address = printable_at(host, "address");
    table.add({printable_at(host, "name"), address,
               up ? coloured(Colour::Green, printable_at(host, "state")) : coloured(Colour::Red, "unknown"),
               address == "local" ? "-" : format_seconds(number_at(host, "since_s")),
               optional_micros(host, "round_trip_us"), optional_micros(host, "clock_offset_us")});
  }
  if (list_at(status, "hosts").empty()) return {};
  std::string text = '\n' + table.text();
  for (const Value& host : list_at(status, "hosts")) {
    const Value* reachable = host.find("reachable");
    if (reachable == nullptr || !reachable->is_bool() || reachable->as_bool()) continue;
    text += coloured(Colour::Red, "host " + printable_at(host, "name") + ": ") + printable_at(host, "state") +
            '\n';
  }
  return text;
}

std::string latency_cell(const Value& connection, std::string_view key) {
  if (number_at(connection, "measured") == 0) return "-";
  return format_seconds(number_at(connection, key) * 1e-6);
}

}  // namespace

std::string connections_table(const Value::List& connections) {
  Table table({{"FROM"},
               {"TO"},
               {"POLICY"},
               {"WRITTEN", Table::Align::Right},
               {"READ", Table::Align::Right},
               {"DROPPED", Table::Align::Right},
               {"LATENCY", Table::Align::Right},
               {"WORST", Table::Align::Right}});
  for (const Value& connection : connections) {
    table.add({printable_at(connection, "from"), printable_at(connection, "to"),
               printable_at(connection, "policy"), fmt::format("{}", number_at(connection, "written")),
               fmt::format("{}", number_at(connection, "read")),
               fmt::format("{}", number_at(connection, "dropped")), latency_cell(connection, "latency_us"),
               latency_cell(connection, "latency_worst_us")});
  }
  return table.text();
}

std::string state_lines(const Value& status) {
  return loss_text(status) + troubles_text(status) + halt_text(status) + commander_text(status) +
         other_controllers(status) + files_text(status) + pools_text(status) + hosts_text(status);
}

std::string faults_text(const Value& status) {
  std::string text;
  for (const Value& difference : list_at(status, "differences")) {
    if (difference.is_string())
      text += coloured(Colour::Yellow, "drift: ") + printable(difference.as_string()) + '\n';
  }
  for (const Value& process : list_at(status, "ended")) {
    text += coloured(Colour::Red, "ended: ") + "process " + printable_at(process, "process") + ' ';
    std::istringstream lines(printable_at(process, "message"));
    for (std::string line; std::getline(lines, line);)
      text += printable(line) + '\n';
  }
  for (const Value& fault : list_at(status, "unresolved"))
    text += coloured(Colour::Red, "unresolved: ") + printable_at(fault, "fault") + '\n';
  return text;
}

}  // namespace segue::cli

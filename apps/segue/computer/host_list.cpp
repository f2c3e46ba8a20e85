// SPDX-License-Identifier: Apache-2.0
#include <segue/base/rounded_text.hpp>
#include <segue/base/text.hpp>
#include <segue/distributed/clock_reading.hpp>
#include <segue/model/files.hpp>
#include <segue/runtime/host_places.hpp>

#include <fmt/core.h>

#include <chrono>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "../command.hpp"
#include "../models.hpp"
#include "../output.hpp"

namespace segue::cli {

namespace {

using type::Value;

/// How long a host may take to answer.
constexpr Duration kPatience = std::chrono::seconds(5);

/// The answer of one host, or the reason why there is none.
struct Answer {
  model::Host host;
  std::optional<Error> error;
  distributed::HostInfo info;
  std::vector<distributed::LeaseInfo> robots;
  distributed::ClockReading clock;
};

Result<void> ask(const distributed::HostPlace& place, Answer& answer) {
  const auto service = place.connect(RealClock::instance().now() + kPatience, {});
  if (!service) return service.error();
  auto info = (*service)->info();
  if (!info) return info.error();
  answer.info = std::move(*info);
  auto robots = (*service)->robots();
  if (!robots) return robots.error();
  answer.robots = std::move(*robots);
  const auto clock = distributed::read_clock(**service);
  if (!clock) return clock.error();
  answer.clock = *clock;
  return {};
}

/// All hosts at the same time.
std::vector<Answer> ask_all(const model::Robot& robot) {
  const auto places = runtime::host_places(robot);
  std::vector<Answer> answers;
  for (const auto& host : robot.hosts) {
    if (!host.is_local()) answers.push_back({host, {}, {}, {}, {}});
  }
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < places.size(); ++i) {
    threads.emplace_back([&place = places[i], &answer = answers[i]] {
      if (auto asked = ask(place, answer); !asked) answer.error = std::move(asked.error());
    });
  }
  for (auto& thread : threads)
    thread.join();
  return answers;
}

Value host_value(const Answer& answer) {
  Value value = Value::map({{"name", answer.host.name.str()},
                            {"address", answer.host.address},
                            {"optional", answer.host.optional},
                            {"reachable", !answer.error}});
  auto& map = value.as_map();
  if (answer.error) {
    map.set("error", to_string(*answer.error));
    return value;
  }
  map.set("software", answer.info.software);
  map.set("architecture", answer.info.architecture);
  map.set("pid", answer.info.pid);
  map.set("round_trip_s", seconds(answer.clock.round_trip));
  map.set("clock_offset_s", seconds(answer.clock.offset));
  Value::List libraries;
  for (const auto& library : answer.info.libraries) {
    libraries.push_back(Value::map({{"name", library.name},
                                    {"digest", library.digest},
                                    {"components", static_cast<std::uint64_t>(library.components.size())}}));
  }
  map.set("libraries", std::move(libraries));
  Value::List robots;
  for (const auto& lease : answer.robots) {
    robots.push_back(Value::map({{"robot", lease.robot},
                                 {"holder", lease.holder},
                                 {"epoch", lease.epoch},
                                 {"left_s", seconds(lease.left)}}));
  }
  map.set("robots", std::move(robots));
  return value;
}

std::string robots_cell(const Answer& answer) {
  std::vector<std::string> texts;
  for (const auto& lease : answer.robots) {
    const bool held = !lease.holder.empty() && lease.left > Duration(0);
    texts.push_back(lease.robot + (held ? " (by " + lease.holder + ")" : " (by nobody)"));
  }
  return texts.empty() ? "-" : listed(texts);
}

std::string signed_seconds(Duration duration) {
  return (duration < Duration(0) ? "-" : "+") + format_seconds(std::chrono::abs(duration));
}

void print_hosts(const std::vector<Answer>& answers) {
  Table table({{"HOST"},
               {"ADDRESS"},
               {"SEGUE"},
               {"PROCESSOR"},
               {"ROUND TRIP", Table::Align::Right},
               {"CLOCK", Table::Align::Right},
               {"LIBRARIES", Table::Align::Right},
               {"ROBOTS"}});
  for (const auto& answer : answers) {
    if (answer.error) {
      table.add({answer.host.name.str(), answer.host.address, coloured(Colour::Red, "unreachable"), "-", "-",
                 "-", "-", "-"});
      continue;
    }
    table.add({answer.host.name.str(), answer.host.address, answer.info.software, answer.info.architecture,
               format_seconds(answer.clock.round_trip), signed_seconds(answer.clock.offset),
               fmt::format("{}", answer.info.libraries.size()), printable(robots_cell(answer))});
  }
  print(table.text());
  for (const auto& answer : answers) {
    if (answer.error) {
      print(coloured(Colour::Red, answer.host.name.str() + ": ") + printable(to_string(*answer.error)) +
            '\n');
    }
  }
}

int list_hosts(const std::string& file, const Context& context) {
  Diagnostics diagnostics;
  const auto robot = model::load_robot(file, diagnostics);
  if (!robot) return report_failure(context, diagnostics);
  const auto answers = ask_all(*robot);
  bool all_reachable = true;
  Value::List values;
  for (const auto& answer : answers) {
    all_reachable = all_reachable && !answer.error;
    values.push_back(host_value(answer));
  }
  if (context.json()) {
    print_json(Value(std::move(values)));
  } else if (answers.empty()) {
    print_line("the robot has no other hosts than this computer; name them under 'hosts' of its file");
  } else {
    print_hosts(answers);
  }
  return all_reachable ? kDone : kUnreachable;
}

}  // namespace

void add_host_list(Verb& host, Context& context) {
  const auto file = std::make_shared<std::string>();
  Verb& verb =
      add_verb(host, context, "list", "show the hosts of a robot, and how well they are",
               "  segue host list robot.yaml\n  segue host list robot.yaml --format json\n\n"
               "CLOCK is how far a host's clock is ahead of this computer's. The exit status is 3 where a\n"
               "host cannot be reached.",
               [file, &context] { return list_hosts(*file, context); });
  verb.option("ROBOT", *file, "the robot file").required();
}

}  // namespace segue::cli

// SPDX-License-Identifier: Apache-2.0
#include <segue/base/rounded_text.hpp>
#include <segue/base/text.hpp>
#include <segue/task_host/port_reader.hpp>

#include <fmt/core.h>

#include <algorithm>
#include <memory>

#include "../connection.hpp"

namespace segue::cli {

namespace {

using type::Value;

struct RateOptions {
  std::vector<std::string> ports;  ///< tasks stand for all of their output ports
  std::size_t count = 0;           ///< of reports; 0: until Ctrl-C
  Duration every = std::chrono::seconds(1);
};

/// The text that a verb shows of the measurements of a port.
using RateText = std::string (*)(const Value& measured);

struct MeasuredPort {
  std::string name;
  std::unique_ptr<control::SampleStream> stream;
};

/// From the times between writes; where there was one write only, from the time that was looked at.
double rate_of(const Value& measured) {
  const double mean = number_at(measured, "mean_s");
  const double span = number_at(measured, "span_s");
  return mean > 0 ? 1 / mean : span > 0 ? number_at(measured, "samples") / span : 0;
}

std::string rate_text(const Value& measured) {
  const auto seconds_at = [&](std::string_view key) { return format_seconds(number_at(measured, key)); };
  std::string text = format_quantity(rate_of(measured), "Hz");
  if (number_at(measured, "mean_s") > 0) {
    text += fmt::format(", period {} ({} to {}, deviation {})", seconds_at("mean_s"), seconds_at("least_s"),
                        seconds_at("most_s"), seconds_at("deviation_s"));
  }
  return text + ", " + counted(static_cast<std::size_t>(number_at(measured, "samples")), "sample");
}

std::string bandwidth_text(const Value& measured) {
  const double size = number_at(measured, "bytes") / number_at(measured, "samples");
  return fmt::format("{}, {} a sample, {}", format_quantity(size * rate_of(measured), "B/s"),
                     format_quantity(size, "B"), format_quantity(rate_of(measured), "Hz"));
}

/// The port of this name, or all output ports of the task of this name but its state.
Result<std::vector<Address>> ports_of(control::RobotService& robot, const std::string& name,
                                      const std::vector<std::string>& tasks) {
  if (std::ranges::count(tasks, name) == 0) {
    if (name.find('.') == std::string::npos) return no_such_task(name, tasks);
    auto address = resolve(robot, name, "PORT");
    if (!address) return address.error();
    return std::vector{std::move(*address)};
  }
  const auto task = robot.task(name);
  if (!task) return task.error();
  std::vector<Address> ports;
  for (const std::string& port : port_names(*task, "output")) {
    if (port != "state") ports.push_back({name, port});
  }
  if (ports.empty()) return fail(ErrorCode::NotFound, "has no output ports", name);
  return ports;
}

Result<std::vector<MeasuredPort>> open_ports(control::RobotService& robot,
                                             const std::vector<std::string>& names) {
  const auto status = robot.status();
  if (!status) return status.error();
  const auto tasks = task_names(*status);
  std::vector<MeasuredPort> measured;
  for (const std::string& name : names) {
    const auto ports = ports_of(robot, name, tasks);
    if (!ports) return ports.error();
    for (const Address& port : *ports) {
      auto stream = robot.open_port(port.task, port.member, task_host::kMeasureWrites);
      if (!stream) return stream.error();
      measured.push_back({port.task + "." + port.member, std::move(*stream)});
    }
  }
  return measured;
}

int show_rates(control::RobotService& robot, const RateOptions& options, RateText text_of,
               const Context& context) {
  auto ports = open_ports(robot, options.ports);
  if (!ports) return failed(context, ports.error());
  std::size_t width = 0;
  for (const MeasuredPort& port : *ports)
    width = std::max(width, port.name.size());
  for (std::size_t report = 0; options.count == 0 || report < options.count; ++report) {
    if (reader_leaves_within(options.every)) return kDone;
    for (const MeasuredPort& port : *ports) {
      auto measured = port.stream->read(1);
      if (!measured) return failed(context, measured.error());
      if (measured->empty() || measured->front().find("span_s") == nullptr)
        return failed(context,
                      fail(ErrorCode::Unsupported, "its process has an earlier version of Segue", port.name));
      Value& found = measured->front();
      if (context.json()) {
        found.as_map().set("port", port.name);
        print_json_line(found);
        continue;
      }
      print_line(fmt::format("{:<{}}  {}", port.name, width,
                             number_at(found, "samples") > 0 ? text_of(found) : "nothing is written"));
    }
    if (ports->size() > 1 && !context.json() && report + 1 != options.count) print_line("");
  }
  return kDone;
}

void add_rate_verb(Verb& app, Context& context, const std::string& name, const std::string& what,
                   const std::string& examples, RateText text_of) {
  const auto options = std::make_shared<RateOptions>();
  Verb& verb = add_verb(app, context, name, what, examples, [options, text_of, &context] {
    return with_robot(
        context, [&](control::RobotService& robot) { return show_rates(robot, *options, text_of, context); });
  });
  verb.option("TASK.PORT", options->ports, "output ports; of a TASK all of them").required();
  verb.option("-n,--count N", options->count, "the number of reports (default: until Ctrl-C)")
      .between(1, kMostLines);
  verb.option("--every DURATION", options->every, "the time that each report is of (default 1s)")
      .between(std::chrono::milliseconds(100), kLongestWait);
  add_robot_option(verb, context);
}

}  // namespace

void add_hz(Verb& app, Context& context) {
  add_rate_verb(
      app, context, "hz", "how often and how regularly output ports are written",
      "  segue hz odometry.pose\n  segue hz laser camera -n 1        # all output ports of two tasks, once\n"
      "  segue hz drive.command --every 10s --format json",
      rate_text);
}

void add_bw(Verb& app, Context& context) {
  add_rate_verb(app, context, "bw", "how many bytes a second are written to output ports",
                "  segue bw laser.scan\n  segue bw camera -n 1", bandwidth_text);
}

}  // namespace segue::cli

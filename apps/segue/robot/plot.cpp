// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/model/condition.hpp>

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "../connection.hpp"
#include "plot_canvas.hpp"

namespace segue::cli {

namespace {

using type::Value;

constexpr std::size_t kPlotBuffer = 10000;
constexpr std::size_t kPlotBatch = 1000;
constexpr std::size_t kMostFields = 4;  // as many as there are colours
constexpr Duration kPlotPoll = std::chrono::milliseconds(5);
constexpr Duration kBetweenPictures = std::chrono::milliseconds(100);

struct PlotOptions {
  std::vector<std::string> fields;  ///< "task.port" or "task.port.field"
  std::size_t count = 0;            ///< of samples; 0: not given
  Duration length{0};               ///< --for; 0: not given
  Duration window = std::chrono::seconds(10);
  Duration timeout = std::chrono::seconds(5);
};

using FieldPath = std::vector<std::string>;

struct PlottedPort {
  std::string task;
  std::string port;
  std::vector<FieldPath> fields;  ///< none: all numbers of a sample
};

double number_of(const Value* value) {
  if (value != nullptr && value->is_number()) return value->as_double();
  if (value != nullptr && value->is_bool()) return value->as_bool() ? 1 : 0;
  return std::numeric_limits<double>::quiet_NaN();
}

bool is_plotted(const Value& value) {
  return value.is_number() || value.is_bool();
}

/// The fields of a sample that are numbers, or are true or false.
void add_numbers(const Value& value, FieldPath& path, std::vector<FieldPath>& found) {
  if (is_plotted(value)) found.push_back(path);
  if (value.is_map()) {
    for (const auto& [key, field] : value.as_map()) {
      path.push_back(key);
      add_numbers(field, path, found);
      path.pop_back();
    }
  } else if (value.is_list()) {
    for (std::size_t at = 0; at < value.as_list().size(); ++at) {
      path.push_back(std::to_string(at));
      add_numbers(value.as_list()[at], path, found);
      path.pop_back();
    }
  }
}

/// The first names, and how many more there are.
std::string named(const std::vector<FieldPath>& fields) {
  constexpr std::size_t kNamed = 20;
  std::vector<std::string> names;
  for (std::size_t at = 0; at < std::min(fields.size(), kNamed); ++at)
    names.push_back(model::field_text(fields[at]));
  const std::string rest =
      fields.size() > kNamed ? fmt::format(" (and {} more)", fields.size() - kNamed) : std::string();
  return listed(names) + rest;
}

/// The longest name of an output port with which the text begins, "port.field".
Result<std::string> port_of(control::RobotService& robot, const Address& address) {
  const auto task = robot.task(address.task);
  if (!task) return task.error();
  std::vector<std::string> outputs;
  std::string best;
  for (const Value& port : list_at(*task, "ports")) {
    if (printable_at(port, "direction") != "output") continue;
    outputs.push_back(printable_at(port, "name"));
    const std::string& name = outputs.back();
    const bool fits = address.member == name || address.member.starts_with(name + '.');
    if (fits && name.size() > best.size()) best = name;
  }
  if (!best.empty()) return best;
  const std::string wanted = address.member.substr(0, address.member.find('.'));
  return fail(ErrorCode::NotFound, fmt::format("{} has no output port {}{}{}", quote(address.task),
                                               quote(wanted), did_you_mean(wanted, outputs),
                                               outputs.empty() ? "" : "; it has: " + listed(outputs)));
}

Result<PlottedPort> plotted_port(control::RobotService& robot, const std::vector<std::string>& texts) {
  std::optional<PlottedPort> plotted;
  for (const std::string& text : texts) {
    const auto address = resolve(robot, text, "PORT");
    if (!address) return address.error();
    const auto port = port_of(robot, *address);
    if (!port) return port.error();
    if (!plotted) plotted = PlottedPort{address->task, *port, {}};
    if (plotted->task != address->task || plotted->port != *port) {
      return fail(ErrorCode::InvalidArgument,
                  fmt::format("fields of one port are plotted at once, but {} is not "
                              "of '{}.{}'",
                              quote(text), plotted->task, plotted->port));
    }
    if (address->member.size() == port->size()) continue;
    const std::string name = address->member.substr(port->size() + 1);
    auto field = model::parse_field(name);
    if (!field)
      return fail(ErrorCode::InvalidArgument,
                  quote(name) + " is not a field such as 'pose.x' or 'path[0].x'");
    plotted->fields.push_back(std::move(*field));
  }
  return std::move(*plotted);
}

/// The fields that were asked for, if this sample has numbers there, else all its numbers.
Result<std::vector<FieldPath>> fields_in(const Value& sample, const PlottedPort& port) {
  std::vector<FieldPath> numbers;
  FieldPath path;
  add_numbers(sample, path, numbers);
  const std::string name = port.task + '.' + port.port;
  if (numbers.empty()) return fail(ErrorCode::InvalidArgument, "its samples have no numbers", name);
  for (const FieldPath& field : port.fields) {
    const Value* value = model::find_field(sample, field);
    if (value != nullptr && is_plotted(*value)) continue;
    return fail(ErrorCode::NotFound,
                fmt::format("its sample has no number {}; it has: {}", quote(model::field_text(field)),
                            named(numbers)),
                name);
  }
  return port.fields.empty() ? numbers : port.fields;
}

/// Shows samples as they come: as a picture, or each in a line.
class Plotter {
 public:
  Plotter(PlottedPort port, const PlotOptions& options, const Context& context)
      : port_(std::move(port)), window_s_(seconds(options.window)), context_(context) {}

  [[nodiscard]] bool has_begun() const { return !lines_.empty(); }

  /// Times are in seconds since the beginning.
  Result<void> add(const Value& sample, double time_s) {
    if (lines_.empty()) {
      if (auto begun = begin(sample); !begun) return begun;
    }
    for (std::size_t at = 0; at < fields_.size(); ++at)
      lines_[at].points.push_back({time_s, number_of(model::find_field(sample, fields_[at]))});
    if (!is_picture_) {
      print_numbers(time_s);
    } else {
      changed_ = true;
    }
    for (PlotLine& line : lines_) {
      while (line.points.front().time_s < time_s - (is_picture_ ? window_s_ : 0))
        line.points.pop_front();
    }
    return {};
  }

  /// Draws the picture, if there is one and it has changed.
  void draw(double now_s) {
    if (!changed_) return;
    changed_ = false;
    print(kClearScreen);
    print(plot_text(lines_, {.from_s = std::max(0.0, now_s - window_s_),
                             .to_s = std::max(now_s, 1e-3),
                             .columns = terminal_columns(STDOUT_FILENO),
                             .rows = terminal_rows(STDOUT_FILENO) - 2}));
    print_line(left_out_);
  }

 private:
  Result<void> begin(const Value& sample) {
    auto fields = fields_in(sample, port_);
    if (!fields) return fields.error();
    fields_ = std::move(*fields);
    if (is_picture_ && fields_.size() > kMostFields) {
      left_out_ = fmt::format("... {} more fields", fields_.size() - kMostFields);
      fields_.resize(kMostFields);
    }
    for (const FieldPath& field : fields_)
      lines_.push_back({model::field_text(field), {}});
    return {};
  }

  void print_numbers(double time_s) const {
    Value fields = Value::map({});
    std::string text = fmt::format("{:.4f}", time_s);
    for (const PlotLine& line : lines_) {
      const double value = line.points.back().value;
      fields.as_map().set(line.name, std::isfinite(value) ? Value(value) : Value());
      text += fmt::format("  {}: {}", printable(line.name), value);
    }
    if (context_.json())
      return print_json_line(Value::map({{"time_s", time_s}, {"fields", std::move(fields)}}));
    print_line(text);
  }

  const PlottedPort port_;
  const double window_s_;
  const Context& context_;
  const bool is_picture_ = !context_.json() && output_is_terminal();
  std::vector<FieldPath> fields_;
  std::vector<PlotLine> lines_;
  std::string left_out_;
  bool changed_ = false;
};

Error no_sample(const PlottedPort& port, const PlotOptions& options) {
  return fail(ErrorCode::DeadlineExceeded,
              fmt::format("no sample arrived from '{}.{}' within {}; check with `segue status` that its task "
                          "is running",
                          port.task, port.port, format_duration(options.timeout)));
}

int plot_samples(control::SampleStream& stream, const PlottedPort& port, const PlotOptions& options,
                 const Context& context) {
  Plotter plotter(port, options, context);
  const TimePoint begin = RealClock::instance().now();
  const double end_s = options.length > Duration(0) ? seconds(options.length) : HUGE_VAL;
  std::size_t left = options.count > 0 ? options.count : SIZE_MAX;
  double last_s = 0;
  double drawn_s = -HUGE_VAL;
  for (double now_s = 0; left > 0 && now_s < end_s;) {
    const auto samples = stream.read(std::min(left, kPlotBatch));
    if (!samples) return failed(context, samples.error());
    now_s = seconds(RealClock::instance().now() - begin);
    const auto count = static_cast<double>(samples->size());
    for (std::size_t at = 0; at < samples->size(); ++at) {
      // Samples that came between two looks are spread over that time.
      const double time_s = last_s + (now_s - last_s) * static_cast<double>(at + 1) / count;
      if (const auto added = plotter.add((*samples)[at], time_s); !added)
        return failed(context, added.error());
    }
    left -= samples->size();
    last_s = now_s;
    if (now_s - drawn_s >= seconds(kBetweenPictures)) {
      plotter.draw(now_s);
      drawn_s = now_s;
    }
    if (reader_leaves_within(samples->empty() ? kPlotPoll : Duration(0))) return kDone;
    if (!plotter.has_begun() && now_s > seconds(options.timeout))
      return failed(context, no_sample(port, options));
  }
  plotter.draw(last_s);
  return kDone;
}

int plot_port(control::RobotService& robot, const PlotOptions& options, const Context& context) {
  const auto port = plotted_port(robot, options.fields);
  if (!port) return failed(context, port.error());
  if (port->fields.size() > kMostFields)
    return failed(context, fail(ErrorCode::InvalidArgument,
                                fmt::format("{} fields are plotted at once at most", kMostFields)));
  const auto stream = robot.open_port(port->task, port->port, kPlotBuffer);
  if (!stream) return failed(context, stream.error());
  return plot_samples(**stream, *port, options, context);
}

}  // namespace

void add_plot(Verb& app, Context& context) {
  const auto options = std::make_shared<PlotOptions>();
  Verb& verb = add_verb(app, context, "plot", "plot numbers of the samples of an output port over time",
                        "  segue plot odometry.pose\n  segue plot odometry.pose.x odometry.pose.y --for 30s\n"
                        "  segue plot camera.markers.markers[1].pose.x --format json",
                        [options, &context] {
                          return with_robot(context, [&](control::RobotService& robot) {
                            return plot_port(robot, *options, context);
                          });
                        });
  verb.option("TASK.PORT", options->fields,
              "an output port (all numbers of its samples), or fields of one as TASK.PORT.FIELD")
      .required();
  verb.option("-n,--count N", options->count, "the number of samples (default: until Ctrl-C)")
      .between(1, kMostLines);
  verb.option("--for DURATION", options->length, "plot the samples of this time")
      .between(std::chrono::milliseconds(1), kLongestWait);
  verb.option("--window DURATION", options->window, "the time that a picture shows (default 10s)")
      .between(std::chrono::milliseconds(100), kLongestWait);
  verb.option("--timeout DURATION", options->timeout, "how long to wait for the first sample (default 5s)");
  add_robot_option(verb, context);
}

}  // namespace segue::cli

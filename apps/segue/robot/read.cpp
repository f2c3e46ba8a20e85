// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>

#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "../connection.hpp"

namespace segue::cli {

namespace {

using type::Value;

constexpr std::size_t kSampleBuffer = 1000;
constexpr std::size_t kSampleBatch = 100;
constexpr Duration kPollInterval = std::chrono::milliseconds(5);

struct ReadOptions {
  std::string port;
  std::size_t count = 0;  ///< 0: not given
  bool follow = false;
  Duration length{0};  ///< --for; 0: not given
  Duration timeout = std::chrono::seconds(5);
};

void print_sample(const Value& sample, const Context& context) {
  if (context.json()) return print_json_line(sample);
  print_line(one_line(sample));
}

/// Limits the samples to be printed by number and time.
class SampleLimit {
 public:
  explicit SampleLimit(const ReadOptions& options)
      : count_(options.count > 0                                ? options.count
               : options.follow || options.length > Duration(0) ? SIZE_MAX
                                                                : 1) {
    if (options.length > Duration(0)) end_ = deadline_in(options.length);
  }
  [[nodiscard]] bool reached() const { return count_ == 0 || (end_ && RealClock::instance().now() >= *end_); }
  /// Whether the end is a point in time, so that receiving no sample until then is not a failure.
  [[nodiscard]] bool is_timed() const { return end_.has_value(); }
  [[nodiscard]] std::size_t left() const { return std::min(count_, kSampleBatch); }
  void printed() { --count_; }

 private:
  std::size_t count_;
  std::optional<TimePoint> end_;
};

int read_samples(control::SampleStream& stream, const ReadOptions& options, const Context& context) {
  SampleLimit limit(options);
  const TimePoint patience = deadline_in(options.timeout);
  bool any = false;
  while (!limit.reached()) {
    const auto samples = stream.read(limit.left());
    if (!samples) return failed(context, samples.error());
    for (const Value& sample : *samples) {
      print_sample(sample, context);
      limit.printed();
    }
    any |= !samples->empty();
    if (reader_leaves_within(samples->empty() ? kPollInterval : Duration(0))) return kDone;
    if (!samples->empty()) continue;
    if (!any && !options.follow && !limit.is_timed() && RealClock::instance().now() > patience) {
      return failed(
          context,
          fail(ErrorCode::DeadlineExceeded,
               fmt::format(
                   "no sample arrived from {} within {}; check with `segue status` that its task is running",
                   quote(options.port), format_duration(options.timeout))));
    }
  }
  return kDone;
}

int read_port(control::RobotService& robot, const ReadOptions& options, const Context& context) {
  const auto address = resolve(robot, options.port, "PORT");
  if (!address) return failed(context, address.error());
  const auto stream = robot.open_port(address->task, address->member, kSampleBuffer);
  if (!stream) return failed(context, stream.error());
  return read_samples(**stream, options, context);
}

}  // namespace

void add_read(Verb& app, Context& context) {
  const auto options = std::make_shared<ReadOptions>();
  Verb& verb = add_verb(app, context, "read", "print the samples of an output port",
                        "  segue read odometry.pose\n  segue read odometry.pose --follow\n"
                        "  segue read laser.scan --count 10 --format json",
                        [options, &context] {
                          return with_robot(context, [&](control::RobotService& robot) {
                            return read_port(robot, *options, context);
                          });
                        });
  verb.option("TASK.PORT", options->port, "an output port of a running task").required();
  verb.option("-n,--count N", options->count, "the number of samples (default 1)").between(1, kMostLines);
  verb.flag("-f,--follow", options->follow, "print samples until Ctrl-C");
  verb.option("--for DURATION", options->length, "print the samples of this time")
      .between(std::chrono::milliseconds(1), kLongestWait);
  verb.option("--timeout DURATION", options->timeout, "how long to wait for the first sample (default 5s)");
  add_robot_option(verb, context);
}

}  // namespace segue::cli

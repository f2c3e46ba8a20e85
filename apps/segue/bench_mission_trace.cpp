// SPDX-License-Identifier: Apache-2.0
#include "bench_mission_trace.hpp"

#include <segue/mission/robot_condition.hpp>

#include <algorithm>
#include <iterator>

namespace segue::cli {

RobotClock::RobotClock(std::shared_ptr<mission::CommandedRobot> robot, std::string port)
    : robot_(std::move(robot)), port_(std::move(port)), thread_([this](const std::stop_token& stop) {
        while (!stop.stop_requested()) {
          read();
          std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
      }) {}

RobotClock::~RobotClock() {
  stop();
}

void RobotClock::stop() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
  read();
}

void RobotClock::read() {
  if (samples_ == nullptr) {
    auto opened = robot_->open(mission::parse_member(port_));
    if (!opened) {
      error_ = opened.error().message;  // its task does not run yet
      return;
    }
    samples_ = std::move(*opened);
  }
  take();
}

void RobotClock::take() {
  const auto taken = samples_->take();
  const TimePoint now = monotonic_now();
  if (!taken) {
    error_ = taken.error().message;
    samples_.reset();
    return;
  }
  if (taken->empty()) return;
  if (taken->back().is_number()) {
    times_.emplace_back(now, taken->back().as_double());
  } else {
    error_ = "its samples are no numbers";
  }
}

std::optional<double> RobotClock::at(TimePoint when) const {
  if (times_.empty()) return std::nullopt;
  const auto after = std::ranges::upper_bound(times_, when, {}, &std::pair<TimePoint, double>::first);
  if (after == times_.begin()) return times_.front().second;
  const auto& [from, before] = *std::prev(after);
  if (after == times_.end()) return before;
  const double part = std::chrono::duration<double>(when - from) / (after->first - from);
  return before + part * (after->second - before);
}

void MissionTrace::observe(const mission::ActionEvent& event) {
  const TimePoint now = monotonic_now();
  const std::lock_guard lock(mutex_);
  const Key key(event.path, event.iteration);
  if (event.kind == mission::ActionEvent::Kind::Began) {
    open_[key] = now;
    return;
  }
  const auto began = open_.find(key);
  if (began == open_.end()) return;
  executions_[key] = {began->second, now, std::string(event.outcome)};
  under_way_.emplace_back(began->second, now);
  open_.erase(began);
}

Duration MissionTrace::idle(TimePoint begin, TimePoint end) const {
  auto intervals = under_way_;
  std::ranges::sort(intervals);
  Duration idle{};
  TimePoint until = begin;
  for (const auto& [from, to] : intervals) {
    if (from > until) idle += from - until;
    until = std::max(until, to);
  }
  return idle + std::max(Duration::zero(), end - until);
}

namespace {

struct Ended {
  Duration duration{};
  std::string outcome;
};
using EndedByExecution = std::map<std::pair<std::string, std::uint64_t>, Ended>;

class Replay final : public mission::ActionRunner {
 public:
  explicit Replay(EndedByExecution executions) : executions_(std::move(executions)) {}

  std::optional<mission::Ending> start(mission::ActionCall& call) override {
    if (call.backward()) return mission::Ending{};
    const auto found = executions_.find({call.path(), call.iteration()});
    if (found == executions_.end()) {
      const mission::Action& action = call.action();
      return end(call, action.expected_duration.value_or(Duration::zero()), action.expected_outcome);
    }
    return end(call, found->second.duration, found->second.outcome);
  }

 private:
  static std::optional<mission::Ending> end(mission::ActionCall& call, Duration after,
                                            const std::string& outcome) {
    mission::Ending ending{call.outcome(outcome).value_or(0), {}};
    if (ending.outcome == mission::kAborted) ending.error = "it aborted in the run that is repeated";
    if (after <= Duration::zero()) return ending;
    call.end_after(after, std::move(ending));
    return std::nullopt;
  }

  const EndedByExecution executions_;
};

}  // namespace

std::shared_ptr<mission::ActionRunner> MissionTrace::replay(
    const std::function<double(TimePoint)>& time) const {
  EndedByExecution ended;
  for (const auto& [key, execution] : executions_) {
    const std::chrono::duration<double> seconds(time(execution.ended) - time(execution.began));
    ended[key] = {std::chrono::duration_cast<Duration>(seconds), execution.outcome};
  }
  return std::make_shared<Replay>(std::move(ended));
}

}  // namespace segue::cli

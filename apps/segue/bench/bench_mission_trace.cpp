// SPDX-License-Identifier: Apache-2.0
#include "bench_mission_trace.hpp"

#include <segue/mission/action.hpp>
#include <segue/model/robot_condition.hpp>

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
    auto opened = robot_->open(mission::parse_member(port_), Wait(TimePoint::max()));
    if (!opened) {
      error_ = opened.error().message;  // its task does not run yet
      return;
    }
    samples_ = std::move(*opened);
  }
  take();
}

void RobotClock::take() {
  const auto taken = samples_->take(Wait(TimePoint::max()));
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
    error_ = "its samples are not numbers";
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

void MissionTrace::observe(const mission::StateEvent& event) {
  if (event.is_container) return;
  const TimePoint now = monotonic_now();
  const Lock lock(mutex_);
  if (event.kind == mission::StateEvent::Kind::Began) {
    open_.push_back({std::string(event.path), event.iteration, now});
    return;
  }
  const auto began = std::ranges::find_if(
      open_, [&](const Open& open) { return open.path == event.path && open.iteration == event.iteration; });
  if (began == open_.end()) return;
  auto& executions = executions_[began->path];
  auto own = std::ranges::find(executions, event.iteration, &Execution::iteration);
  if (own == executions.end()) own = executions.insert(own, Execution{event.iteration, {}, {}, {}});
  own->began = began->began;
  own->ended = now;
  own->outcome = event.outcome;
  under_way_.emplace_back(began->began, now);
  open_.erase(began);
}

namespace {

using Intervals = std::vector<std::pair<TimePoint, TimePoint>>;

/// How long at least one of them lasted.
Duration covered(Intervals intervals) {
  std::ranges::sort(intervals);
  Duration covered{};
  TimePoint until = TimePoint::min();
  for (const auto& [from, to] : intervals) {
    if (to > until) covered += to - std::max(from, until);
    until = std::max(until, to);
  }
  return covered;
}

}  // namespace

Duration MissionTrace::idle(TimePoint begin, TimePoint end) const {
  const Lock lock(mutex_);
  return std::max(Duration::zero(), end - begin - covered(under_way_));
}

Duration MissionTrace::planning() const {
  Intervals intervals;
  const Lock lock(mutex_);
  for (const auto& [path, executions] : executions_) {
    if (!plans_.contains(path)) continue;
    for (const Execution& execution : executions)
      intervals.emplace_back(execution.began, execution.ended);
  }
  return covered(std::move(intervals));
}

namespace {

struct Ended {
  Duration duration{};
  std::string outcome;
};
using EndedByPath = std::map<std::string, std::vector<Ended>>;

class Replay final : public mission::ActionRunner {
 public:
  explicit Replay(EndedByPath executions) : executions_(std::move(executions)) {}

  std::optional<mission::Ending> start(mission::ActionCall& call) override {
    if (call.backward()) return mission::Ending{};
    const std::string path = call.path();
    auto& begun = begun_[path];
    const auto turn = static_cast<std::size_t>(std::ranges::find(begun, call.iteration()) - begun.begin());
    if (turn == begun.size()) begun.push_back(call.iteration());
    const auto found = executions_.find(path);
    if (found == executions_.end() || turn >= found->second.size()) {
      const mission::Action& action = call.action();
      return end(call, action.expected_duration.value_or(Duration::zero()), action.expected_outcome);
    }
    return end(call, found->second[turn].duration, found->second[turn].outcome);
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

  const EndedByPath executions_;
  std::map<std::string, std::vector<std::uint64_t>> begun_;  ///< iterations, on the engine's thread
};

}  // namespace

std::shared_ptr<mission::ActionRunner> MissionTrace::replay(
    const std::function<double(TimePoint)>& time) const {
  EndedByPath ended;
  const Lock lock(mutex_);
  for (const auto& [path, executions] : executions_) {
    for (const Execution& execution : executions) {
      const std::chrono::duration<double> seconds(time(execution.ended) - time(execution.began));
      ended[path].push_back({std::chrono::duration_cast<Duration>(seconds), execution.outcome});
    }
  }
  return std::make_shared<Replay>(std::move(ended));
}

}  // namespace segue::cli

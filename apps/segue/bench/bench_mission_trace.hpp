// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/mutex.hpp>
#include <segue/mission/action_runner.hpp>
#include <segue/mission/commanded_robot.hpp>

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

/// When the actions of a run were under way, by which clock.
namespace segue::cli {

/// Reads a port of the robot with its own time in seconds, in a thread of its own.
class RobotClock {
 public:
  RobotClock(std::shared_ptr<mission::CommandedRobot> robot, std::string port);
  ~RobotClock();
  RobotClock(const RobotClock&) = delete;
  RobotClock& operator=(const RobotClock&) = delete;

  /// Reads once more, and no more.
  void stop();
  /// The robot's time at `when`, interpolated between two samples; before the first sample, the time in that
  /// one. Nothing where no sample came; then error() says why. Requires stop().
  [[nodiscard]] std::optional<double> at(TimePoint when) const;
  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  void read();
  void take();

  const std::shared_ptr<mission::CommandedRobot> robot_;
  const std::string port_;
  std::unique_ptr<mission::PortSamples> samples_;
  std::vector<std::pair<TimePoint, double>> times_;  ///< ascending
  std::string error_;
  std::jthread thread_;  ///< uses the rest until stop()
};

/// Records what a run of a mission does. observe() on any thread, the rest after the run.
class MissionTrace {
 public:
  /// `planning`: the paths of the states that plan.
  explicit MissionTrace(std::set<std::string, std::less<>> planning) : plans_(std::move(planning)) {}
  void observe(const mission::StateEvent& event);

  /// How long no action was under way between `begin` and `end`.
  [[nodiscard]] Duration idle(TimePoint begin, TimePoint end) const;
  /// How long at least one of the states that plan was under way.
  [[nodiscard]] Duration planning() const;
  /// Repeats the run: each execution takes as long as it did on the clock, and ends as it did. Executions
  /// that did not happen take as long as expected. `time`: the seconds on a clock.
  [[nodiscard]] std::shared_ptr<mission::ActionRunner> replay(
      const std::function<double(TimePoint)>& time) const;

 private:
  struct Execution {
    std::uint64_t iteration = 0;
    TimePoint began;
    TimePoint ended;
    std::string outcome;
  };
  struct Open {
    std::string path;
    std::uint64_t iteration = 0;
    TimePoint began;
  };

  const std::set<std::string, std::less<>> plans_;
  mutable Mutex mutex_;  ///< protects what follows
  std::vector<Open> open_ SEGUE_GUARDED_BY(mutex_);
  std::vector<std::pair<TimePoint, TimePoint>> under_way_ SEGUE_GUARDED_BY(mutex_);
  /// The executions of each path, in the order in which their iterations ended first. Of several executions
  /// with one iteration it keeps the last, which is the one that counts. Modes and loops count iterations in
  /// different ways.
  std::map<std::string, std::vector<Execution>> executions_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::cli

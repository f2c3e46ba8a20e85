// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/runtime/embedded_robot.hpp>

#include <support/forwarding_commanded_robot.hpp>
#include <support/random_networks.hpp>

#include <atomic>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

namespace segue::testing {

/// The rover of example 08 with its controllers, on stand-ins of its components in this process, and with two
/// pools of planners in processes: `planner` of one to three or another range, `scout` of none to two.
/// Planners that nobody has needed for a moment leave.
class RoverOnStandIns {
 public:
  explicit RoverOnStandIns(Random& random);
  /// Leaves no process.
  ~RoverOnStandIns();
  RoverOnStandIns(const RoverOnStandIns&) = delete;
  RoverOnStandIns& operator=(const RoverOnStandIns&) = delete;

  runtime::Runtime& runtime() { return robot_->runtime(); }
  [[nodiscard]] std::string events();

 private:
  std::filesystem::path folder_;
  std::optional<runtime::EmbeddedRobot> robot_;
};

/// A robot that kills some of the planners which it is asked for, before they are called, while they work, or
/// while others are, and that has a battery. Thread safe.
class RobotWithKilledPlanners final : public ForwardingCommandedRobot {
 public:
  RobotWithKilledPlanners(std::shared_ptr<mission::CommandedRobot> inner, std::uint64_t seed, int kills)
      : ForwardingCommandedRobot(std::move(inner)), random_(seed), kills_left_(kills) {}

  void drain_battery() { battery_is_low_ = true; }
  /// How many processes got a signal.
  [[nodiscard]] int kills() const { return kills_; }
  /// How many calls were not answered by their planner.
  [[nodiscard]] int lost_calls() const { return lost_calls_; }
  /// The planners that missions were given.
  [[nodiscard]] std::set<std::string> planners() const;

  void take_instance(const model::InstanceQuestion& what, const Wait& wait,
                     model::InstanceAnswer answered) override;
  Result<type::Value> call(const mission::Member& operation, const type::Value& arguments,
                           const Wait& wait) override;

 private:
  enum class Kill { None, Before, Meanwhile, Another };
  /// What happens to the planner that is called now.
  Kill next_kill();
  void kill(const std::string& planner);
  /// Some planner other than that one, which need not be at work.
  void kill_another(const std::string& planner);
  /// Once it works, unless the call is over before.
  void kill_at_work(const std::string& planner, const std::stop_token& is_over);

  std::atomic<bool> battery_is_low_ = false;
  std::atomic<int> kills_ = 0;
  std::atomic<int> lost_calls_ = 0;
  mutable Mutex mutex_;
  Random random_ SEGUE_GUARDED_BY(mutex_);
  int kills_left_ SEGUE_GUARDED_BY(mutex_);
  std::map<std::string, int> pids_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::testing

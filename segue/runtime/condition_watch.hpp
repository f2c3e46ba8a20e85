// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/host/task_host.hpp>
#include <segue/model/robot_condition.hpp>
#include <segue/type/value.hpp>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <thread>

namespace segue::runtime::detail {

/// Watches one condition on the robot, in a thread of its own, so that a process that is silent delays no
/// other condition. What holds when the watch begins counts: conditions are levels, not edges.
class ConditionWatch {
 public:
  static constexpr Duration kPeriod = std::chrono::milliseconds(5);
  /// How long one look may take; what does not answer by then is not seen.
  static constexpr Duration kLook = std::chrono::milliseconds(200);

  enum class From {
    Now,     ///< whatever the task has said
    Update,  ///< of a task that runs, what it says after its next update
  };
  /// `changed` is called in the watch's thread after each change of holds(). `host` must outlive this.
  ConditionWatch(host::TaskHost& host, model::RobotCondition condition, From from,
                 std::function<void()> changed);
  /// Waits for the look in progress.
  ~ConditionWatch();
  ConditionWatch(const ConditionWatch&) = delete;
  ConditionWatch& operator=(const ConditionWatch&) = delete;

  /// False, too, where it cannot be seen.
  [[nodiscard]] bool holds() const { return holds_.load(); }
  [[nodiscard]] const model::RobotCondition& condition() const { return condition_; }

 private:
  void work(const std::stop_token& stop);
  bool look();
  bool look(const model::TaskReaches& when);
  bool look(const model::SampleShows& when);
  bool look(const model::OperationAnswers& when);

  host::TaskHost& host_;
  const model::RobotCondition condition_;
  const From from_;
  const std::function<void()> changed_;
  std::atomic<bool> holds_ = false;
  // Of the thread:
  std::optional<std::uint64_t> first_cycle_;  ///< of the task, when it was seen first
  std::unique_ptr<host::PortReader> reader_;  ///< null: not open
  std::optional<type::Value> last_;           ///< sample
  TimePoint next_call_{};                     ///< operations are not asked more often
  std::stop_source stop_;
  std::thread thread_;
};

}  // namespace segue::runtime::detail

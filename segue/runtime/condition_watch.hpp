// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/question.hpp>
#include <segue/model/robot_condition.hpp>
#include <segue/task_host/task_host.hpp>
#include <segue/type/value.hpp>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

namespace segue::runtime::detail {

/// Watches one condition on the robot, in a thread of its own, so that a process that is silent delays no
/// other condition. Its task says when it changes (TaskHost::watch), its port when there are samples
/// (PortReader::next). What holds when the watch begins counts:
/// conditions are levels, not edges.
class ConditionWatch {
 public:
  /// Between two questions for samples, at least.
  static constexpr Duration kBetweenSamples = std::chrono::milliseconds(5);
  /// How long an operation may take; what does not answer by then is not seen.
  static constexpr Duration kCall = std::chrono::milliseconds(200);
  /// Between two calls of an operation, at least.
  static constexpr Duration kBetweenCalls = std::chrono::milliseconds(10);
  /// How long a question for a task waits, and an operation of a task that does not update is not called.
  static constexpr Duration kPatience = std::chrono::milliseconds(500);
  /// After which a task or a port that is not there is asked for again.
  static constexpr Duration kAgain = std::chrono::milliseconds(10);

  enum class From {
    Now,     ///< whatever the task has said
    Update,  ///< of a task that runs, what it says after its next update
  };
  /// `changed` is called in the watch's thread after each change of holds(). `host` must outlive this.
  ConditionWatch(task_host::TaskHost& host, model::RobotCondition condition, From from,
                 std::function<void()> changed);
  /// Waits for the look in progress.
  ~ConditionWatch();
  ConditionWatch(const ConditionWatch&) = delete;
  ConditionWatch& operator=(const ConditionWatch&) = delete;

  /// False, too, where it cannot be seen.
  [[nodiscard]] bool holds() const { return holds_.load(); }
  [[nodiscard]] const model::RobotCondition& condition() const { return condition_; }

 private:
  enum class Updates { None, First, Each };  ///< that are to be told
  void work(const std::stop_token& stop);
  /// Takes in what the host has said of that task, and asks again; whether it has said something.
  bool follow(const std::string& task, Updates updates);
  /// Opens the port where it is time; whether it is open.
  bool has_reader(const model::Member& port);
  /// Takes in the samples that have come, and asks for more.
  std::vector<type::Value> take_samples();
  [[nodiscard]] bool has_news() const;
  bool poll();
  bool poll(const model::TaskReaches& when);
  bool poll(const model::SampleShows& when);
  bool poll(const model::OperationAnswers& when);

  task_host::TaskHost& host_;
  const model::RobotCondition condition_;
  const From from_;
  const std::function<void()> changed_;
  std::atomic<bool> holds_ = false;
  // Of the thread:
  const std::shared_ptr<Bell> bell_ = std::make_shared<Bell>();
  Question<task_host::TaskLevel> question_{bell_};
  std::optional<task_host::TaskLevel> level_;      ///< nothing: the task cannot be seen
  std::optional<std::uint64_t> first_update_;      ///< of the task, when it was seen first
  TimePoint ask_at_{};                             ///< not before then
  TimePoint next_poll_{};                          ///< although the bell does not ring
  std::unique_ptr<task_host::PortReader> reader_;  ///< null: not open
  Question<std::vector<type::Value>> samples_{bell_};
  TimePoint read_at_{};              ///< the port is not opened or asked before then
  std::optional<type::Value> last_;  ///< sample
  bool is_due_ = false;              ///< the operation is to be called
  TimePoint next_call_{};            ///< not before then
  std::stop_source stop_;
  std::thread thread_;
};

}  // namespace segue::runtime::detail

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/control/robot_service.hpp>
#include <segue/task_host/watches.hpp>

#include <support/fake_robot_service.hpp>

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ros2::testing {

/// A running robot whose tasks are exposed in tests.
class ShownRobot final : public segue::control::FakeRobotService {
 public:
  using Value = segue::type::Value;
  template <class T>
  using Result = segue::Result<T>;
  using FakeRobotService::status;
  using FakeRobotService::task;

  ShownRobot();

  /// One with properties of all kinds, and with operations.
  void add_task(const std::string& id, const std::string& component = "demo::Drive");
  void remove_task(const std::string& id);
  void set_state(const std::string& id, segue::TaskState state);
  static Value properties();  ///< of new tasks
  Value property(const std::string& id, const std::string& name);
  /// As somebody else sets it.
  void change(const std::string& id, const std::string& property, const Value& value);
  /// As a switch does that configures the task anew.
  void configure(const std::string& id, const Value& properties);
  /// Whoever asks for a report of that task waits until `release`, and opens `entered`.
  void silence(const std::string& id);
  void log(const std::string& message, int lines = 1);
  /// When the lines that there are have been told first.
  std::optional<segue::TimePoint> told();
  /// The events so far leave.
  void forget_events();
  /// Called with each property that is set, without a lock; its failure refuses that.
  std::function<Result<void>(const std::string& property)> on_set = [](const std::string&) {
    return Result<void>();
  };
  std::vector<segue::control::Sender> senders();
  std::atomic<int> reports{0};      ///< that were asked for
  std::atomic<int> event_looks{0};  ///< how often events were

  Result<Value> status(const segue::Wait&) override;
  Result<Value> task(std::string_view id, const segue::Wait&) override;
  void watch(const segue::task_host::LevelQuestion& question, const segue::Wait& wait,
             segue::control::RobotLevelAnswer answered) override;
  void changes(std::uint64_t seen, const segue::Wait& wait, segue::control::ChangesAnswer answered) override;
  Result<void> set_property(std::string_view task, std::string_view property, const Value& value,
                            const segue::control::Sender& sender, const segue::Wait&) override;
  Result<Value> call(std::string_view task, std::string_view operation, const Value&,
                     const segue::control::Sender&, const segue::Wait&) override;
  Result<Value> events(std::uint64_t after, const segue::Wait& wait) override;

 private:
  using Watches = segue::task_host::detail::Watches;
  struct Task {
    std::string component;
    segue::TaskState state = segue::TaskState::PreOperational;
    Value properties;
  };

  void note(const std::string& kind, const std::string& subject) SEGUE_REQUIRES(mutex_);

  segue::Mutex mutex_;
  segue::StoppableConditionVariable noted_;
  std::map<std::string, Task, std::less<>> tasks_ SEGUE_GUARDED_BY(mutex_);
  std::string silent_task_ SEGUE_GUARDED_BY(mutex_);
  std::vector<segue::control::Sender> senders_ SEGUE_GUARDED_BY(mutex_);
  Value::List lines_ SEGUE_GUARDED_BY(mutex_);
  std::optional<segue::TimePoint> told_ SEGUE_GUARDED_BY(mutex_);
  Value::List events_ SEGUE_GUARDED_BY(mutex_);
  std::uint64_t last_event_ SEGUE_GUARDED_BY(mutex_) = 0;
  std::uint64_t count_ SEGUE_GUARDED_BY(mutex_) = 1;
  Watches watches_;  ///< destroyed first: its questions use all others
};

}  // namespace ros2::testing

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/mission_robot/fake_commanded_robot.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace segue::mission {

/// May lose its task, and mends it when the test says so.
class FakeMendingRobot final : public FakeCommandedRobot {
 public:
  void watch(const TaskQuestion& question, const Wait& wait, TaskAnswer answered) override {
    const auto once = std::make_shared<Once>(std::move(answered));
    {
      const Lock lock(mutex_);
      open_.push_back(once);
    }
    if (is_gone()) return once->answer(gone());
    FakeCommandedRobot::watch(question, wait,
                              [once](Result<TaskView> view) { once->answer(std::move(view)); });
  }
  Result<ControllerTrouble> trouble(std::string_view controller, const Wait& wait) override {
    auto trouble = FakeCommandedRobot::trouble(controller, wait);
    const Lock lock(mutex_);
    if (trouble) trouble->repair = repair_;
    if (!repair_.empty()) ++waits_;
    waited_.notify_all();
    return trouble;
  }

  Result<type::Value> call(const Member& operation, const type::Value& arguments, const Wait& wait) override {
    if (is_losing(operation.name)) lose_task();
    if (is_refused(operation.name)) return fail(ErrorCode::HookFailed, "refused by the test");
    if (is_gone()) return gone();
    return FakeCommandedRobot::call(operation, arguments, wait);
  }

  /// The task is lost when that operation is called next, which does nothing then.
  void lose_task_at(const std::string& operation) {
    const Lock lock(mutex_);
    losing_ = operation;
  }
  void refuse(const std::string& operation) {
    const Lock lock(mutex_);
    refused_ = operation;
  }
  void lose_task() {
    std::vector<std::shared_ptr<Once>> open;
    {
      const Lock lock(mutex_);
      repair_ = "task 'planner' is gone";
      open.swap(open_);
    }
    for (const auto& one : open)
      one->answer(gone());
  }
  void mend_task() {
    const Lock lock(mutex_);
    repair_.clear();
  }
  /// An action has been told that the task is being mended.
  void wait_until_waited_for() {
    Lock lock(mutex_);
    EXPECT_TRUE(waited_.wait_for(mutex_, std::chrono::seconds(60), [&] { return waits_ > 2; }));
  }

 private:
  struct Once {
    explicit Once(TaskAnswer to) : answered(std::move(to)) {}
    void answer(Result<TaskView> view) {
      if (!is_answered.exchange(true)) answered(std::move(view));
    }
    std::atomic<bool> is_answered = false;
    const TaskAnswer answered;
  };
  static Error gone() { return fail(ErrorCode::NotFound, "no task planner runs"); }
  bool is_gone() {
    const Lock lock(mutex_);
    return !repair_.empty();
  }

  bool is_losing(const std::string& operation) {
    const Lock lock(mutex_);
    return operation == losing_ && !std::exchange(losing_, "").empty();
  }
  bool is_refused(const std::string& operation) {
    const Lock lock(mutex_);
    return operation == refused_;
  }

  Mutex mutex_;  ///< protects all below
  ConditionVariable waited_;
  std::string losing_;
  std::string refused_;
  std::vector<std::shared_ptr<Once>> open_;
  std::string repair_;
  int waits_ = 0;
};

}  // namespace segue::mission

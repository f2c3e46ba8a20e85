// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/mission/commanded_robot.hpp>
#include <segue/mission_robot/fake_changes.hpp>
#include <segue/mission_robot/fake_port.hpp>
#include <segue/mission_robot/fake_task.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

namespace segue::mission {

/// Notes what it is asked, and is as the test says.
class FakeCommandedRobot : public CommandedRobot {
 public:
  Result<void> request(const ControllerRequest& what, const Wait& /*wait*/) override {
    std::string text = "request";
    for (const std::string& controller : what.controllers)
      text += " " + controller;
    for (const MemberValue& one : what.properties)
      text += " " + to_string(one.member) + "=" + std::to_string(one.value.as_double());
    const auto answered = answer(what);
    changes_.add();
    note(text);  // last: what a test does once it has been asked comes after the answer
    return answered;
  }
  Result<ControllerTrouble> trouble(std::string_view controller, const Wait& /*wait*/) override {
    const Lock lock(mutex_);
    ++polls_;
    asked_one_.notify_all();
    if (vanished_) return fail(ErrorCode::Unavailable, "the test took the robot away");
    if (taken_over_) return ControllerTrouble{kTakenOver};
    return ControllerTrouble{runs_ == controller ? trouble_ : "the robot runs " + runs_, broken_};
  }
  Result<std::optional<std::string>> lost_command(const std::stop_token& /*stop*/) override {
    const Lock lock(mutex_);
    return taken_over_ ? std::optional<std::string>(kTakenOver) : std::nullopt;
  }
  Result<ControllerConflicts> conflicts(const Wait& /*wait*/) override { return ControllerConflicts{}; }
  Result<void> prepare(const std::vector<std::string>& /*controllers*/, const Wait& /*wait*/) override {
    return {};
  }
  Result<type::Value> call(const Member& operation, const type::Value& arguments,
                           const Wait& /*wait*/) override {
    if (operation.name == "failed") {
      const Lock lock(mutex_);
      return type::Value(failed_);
    }
    const type::Value* goal = arguments.find("goal");
    note("call " + to_string(operation) + (goal == nullptr ? "" : " " + goal->as_string()));
    return type::Value();
  }
  Result<void> set(const Member& property, const type::Value& value, const Wait& /*wait*/) override {
    note("set " + to_string(property) + " " + std::to_string(value.as_double()));
    return {};
  }
  Result<void> write(const Member& port, const type::Value& value, const Wait& /*wait*/) override {
    note("write " + to_string(port) + " " + value.as_string());
    return {};
  }
  /// Each question is another update. The task "silent" says how it is, and is silent afterwards.
  void watch(const TaskQuestion& question, const Wait& /*wait*/, TaskAnswer answered) override {
    if (question.task == "silent" && question.seen) return;
    if (question.task != "planner" && question.task != "silent")
      return answered(fail(ErrorCode::NotFound, "no task " + question.task + " runs"));
    const auto answer = [&] {
      const Lock lock(mutex_);
      ++watches_;
      asked_one_.notify_all();
      return task_.watch(question, std::move(answered), changes_.count());
    }();
    answer();
  }
  void changes(std::uint64_t seen, const Wait& /*wait*/, ChangesAnswer answered) override {
    changes_.watch(seen, std::move(answered));
  }
  Result<std::unique_ptr<PortSamples>> open(const Member& port, const Wait& /*wait*/) override {
    note("open " + to_string(port));
    return port_.open();
  }

  void become(const std::string& state) {
    change([&] { task_.view.state_name = state; });
  }
  void stand_still() {
    change([&] { task_.updates = false; });
  }
  void show(type::Value sample) { port_.show(std::move(sample)); }
  void fail_by_call() {
    change([&] { failed_ = true; });
  }
  void lose(const std::string& why) {
    change_trouble([&] { trouble_ = why; });
  }
  void break_task(const std::string& task) {
    change_trouble([&] { broken_.push_back({task, "task '" + task + "' is in exception"}); });
  }
  void switch_away() {
    change_trouble([&] { runs_ = "explore"; });
  }
  void take_over() {
    change_trouble([&] { taken_over_ = true; });
  }
  void vanish(bool is_away) {
    change_trouble([&] { vanished_ = is_away; });
  }
  void refuse() {
    change([&] { refuses_ = true; });
  }
  /// Changes of what runs and who commands are told to nobody any more; tasks still say how they are.
  void tell_no_changes() { changes_.be_silent(); }
  std::vector<std::string> asked() {
    const Lock lock(mutex_);
    return asked_;
  }
  /// How often somebody has asked whether a controller runs.
  std::size_t polls() {
    const Lock lock(mutex_);
    return polls_;
  }
  void wait_until_polled(std::size_t times) {
    wait_until([&] { return polls_ >= times; });
  }
  /// Questions for the task so far.
  std::size_t watches() {
    const Lock lock(mutex_);
    return watches_;
  }
  void wait_until_watched(std::size_t questions) {
    wait_until([&] { return watches_ >= questions; });
  }
  /// An update that changes nothing else.
  void update() {
    change([&] { ++task_.view.updates; });
  }
  void wait_until_asked(const std::string& what) {
    wait_until([&] { return std::ranges::count(asked_, what) > 0; }, what);
  }

 private:
  static constexpr const char* kTakenOver = "the robot was taken over by somebody";

  void wait_until(const std::function<bool()>& is_so, const std::string& what = {}) {
    Lock lock(mutex_);
    EXPECT_TRUE(asked_one_.wait_for(mutex_, std::chrono::seconds(60), is_so)) << what;
  }
  Result<void> answer(const ControllerRequest& what) {
    const Lock lock(mutex_);
    if (taken_over_) return fail(ErrorCode::InvalidState, kTakenOver);
    if (refuses_) return fail(ErrorCode::InvalidState, "refused by the test");
    runs_ = what.controllers.empty() ? "" : what.controllers.front();
    return {};
  }
  void change(const std::function<void()>& how) {
    const Lock lock(mutex_);
    how();
    task_.answer_waiting(changes_.count());
  }
  /// Changes the answer of trouble().
  void change_trouble(const std::function<void()>& how) {
    change(how);
    changes_.add();
  }
  void note(std::string what) {
    const Lock lock(mutex_);
    asked_.push_back(std::move(what));
    asked_one_.notify_all();
  }

  FakePort port_;
  FakeChanges changes_;
  Mutex mutex_;  ///< protects all below
  ConditionVariable asked_one_;
  std::vector<std::string> asked_;
  std::string runs_;
  std::string trouble_;
  std::vector<ControllerTrouble::Task> broken_;
  FakeTask task_;
  std::size_t polls_ = 0;
  std::size_t watches_ = 0;
  bool failed_ = false;
  bool refuses_ = false;
  bool taken_over_ = false;
  bool vanished_ = false;
};

}  // namespace segue::mission

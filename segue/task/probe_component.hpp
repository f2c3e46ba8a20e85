// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/virtual_clock.hpp>
#include <segue/task/component.hpp>
#include <segue/task/manual_executor.hpp>
#include <segue/task/port_access.hpp>
#include <segue/task/task.hpp>

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

/// For tests only: a component that records which hooks ran and does in them what the test wants.
namespace segue::task::test {

class Probe : public Component {
 public:
  InputPort<int> input{*this, "input"};
  OutputPort<int> output{*this, "output"};
  Property<double> gain{*this, "gain", 1.5, PropertyOptions{.live = true, .doc = "of the filter"}};
  Property<std::string> device{*this, "device", "/dev/x"};
  Property<std::vector<int>> limits{*this, "limits", {1, 2}, PropertyOptions{.live = true}};

  State settling{*this, "SETTLING"};
  State tracking{*this, "TRACKING"};
  ErrorState sensor_lost{*this, "SENSOR_LOST"};
  ErrorState too_hot{*this, "TOO_HOT"};

  explicit Probe(const ComponentOptions& options = {}) : Component(options) {}

  using Component::error;
  using Component::exception;
  using Component::fatal;
  using Component::id;
  using Component::log;
  using Component::now;
  using Component::recovered;
  using Component::trigger_fd;

  std::vector<std::string> hooks;
  std::optional<SavedState> saved;     ///< returned by save_state
  std::optional<SavedState> restored;  ///< passed to restore_state
  /// Called in every hook with its name ("start"); may throw.
  std::function<Result<void>(const std::string& hook)> act = [](const std::string&) -> Result<void> {
    return {};
  };

 protected:
  Result<void> on_configure() override { return note("configure"); }
  Result<void> on_start() override { return note("start"); }
  void on_update() override { static_cast<void>(note("update")); }
  void on_error() override { static_cast<void>(note("error")); }
  void on_stop() override { static_cast<void>(note("stop")); }
  void on_cleanup() override { static_cast<void>(note("cleanup")); }
  Result<void> on_recover() override { return note("recover"); }
  std::optional<SavedState> save_state() override {
    static_cast<void>(note("save_state"));
    return saved;
  }
  Result<void> restore_state(const SavedState& state) override {
    restored = state;
    return note("restore_state");
  }

 private:
  Result<void> note(const std::string& hook) {
    hooks.push_back(hook);
    return act(hook);
  }
};

/// A deadline that is far enough for anything a test waits for.
inline TimePoint soon() {
  return RealClock::instance().now() + std::chrono::seconds(60);
}

/// A task on a manual executor and a virtual clock.
class TaskTest : public ::testing::Test {
 protected:
  TaskTest() { make({.trigger = Trigger::PortDriven}); }
  ~TaskTest() override { task.reset(); }

  void make(const Activity& activity) {
    auto component = std::make_unique<Probe>();
    probe = component.get();
    auto made = Task::create("probe", std::move(component), activity, executor);
    ASSERT_TRUE(made) << to_string(made.error());
    task = std::move(*made);
  }
  /// Brings the task to `state` directly and clears the record of hooks.
  void bring_to(TaskState state) {
    if (state == TaskState::Exception || state == TaskState::Fatal) {
      probe->act = [this, state](const std::string&) -> Result<void> {
        if (state == TaskState::Fatal)
          probe->fatal("dead");
        else
          probe->exception("broken");
        return {};
      };
      static_cast<void>(task->configure(soon()));
    } else if (state != TaskState::PreOperational) {
      ASSERT_TRUE(task->configure(soon()));
      if (state != TaskState::Stopped) {
        ASSERT_TRUE(task->start(soon()));
      }
    }
    if (state == TaskState::RunTimeError) {
      probe->act = [this](const std::string&) -> Result<void> {
        probe->error(probe->sensor_lost, "no echo");
        return {};
      };
      update();
    }
    probe->act = [](const std::string&) -> Result<void> { return {}; };
    ASSERT_EQ(task->state(), state);
    probe->hooks.clear();
  }
  /// Makes the task update once, as a sample would.
  void update() {
    InputPortAccess::notify(probe->input);
    executor->run_ready();
  }

  VirtualClock clock;
  std::shared_ptr<ManualExecutor> executor = std::make_shared<ManualExecutor>(clock);
  std::unique_ptr<Task> task;
  Probe* probe = nullptr;
};

}  // namespace segue::task::test

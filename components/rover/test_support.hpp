// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/virtual_clock.hpp>
#include <segue/sample_link/local.hpp>
#include <segue/task/manual_executor.hpp>
#include <segue/task/task.hpp>
#include <segue/task_host/component_library.hpp>

#include <support/paths.hpp>

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace rover::testing {

inline segue::TimePoint soon() {
  return segue::RealClock::instance().now() + std::chrono::seconds(60);
}

/// The components of the rover in one thread and in virtual time: every run is the same.
class SteppedRover {
 public:
  /// Loads the library as robots do. `simulation`: properties of the task "rover".
  explicit SteppedRover(const segue::type::Value& simulation) {
    ::setenv("SEGUE_LIBRARY_PATH", segue::paths::kComponentFolder, 1);
    const auto loaded = libraries_.load("segue_components_rover");
    EXPECT_TRUE(loaded) << to_string(loaded.error());
    add("rover", "rover::Simulation", simulation);
    add("wheels", "rover::RoverDrive");
    add("arm", "rover::ArmDriver");
    add("gripper", "rover::Gripper");
    wire("rover", "wheel_state", "wheels", "measured");
    wire("wheels", "wheels", "rover", "wheels");
    wire("rover", "arm_state", "arm", "measured");
    wire("arm", "set_points", "rover", "arm");
    wire("rover", "gripper_state", "gripper", "measured");
    wire("gripper", "command", "rover", "gripper");
  }

  void add(const std::string& id, const char* component, const segue::type::Value& properties = {}) {
    auto made = libraries_.create(segue::model::ComponentName(component));
    ASSERT_TRUE(made) << to_string(made.error());
    const segue::Activity activity = (*made)->options().activity;
    auto task = segue::task::Task::create(id, std::move(*made), activity, executor_);
    ASSERT_TRUE(task) << to_string(task.error());
    if (!properties.is_null()) {
      const auto set = (*task)->set_properties(properties, soon());
      ASSERT_TRUE(set) << to_string(set.error());
    }
    const auto configured = (*task)->configure(soon());
    ASSERT_TRUE(configured) << to_string(configured.error());
    tasks_[id] = std::move(*task);
  }

  void wire(const std::string& from, const char* output, const std::string& to, const char* input) {
    const auto made = segue::sample_link::connect(*tasks_[from]->component().find_output(output),
                                                  *tasks_[to]->component().find_input(input), {});
    ASSERT_TRUE(made) << to_string(made.error());
  }

  void start() {
    for (const auto& [id, task] : tasks_)
      ASSERT_TRUE(task->start(soon())) << id;
  }

  void advance(segue::Duration time) { executor_->advance(time); }

  void call(const std::string& id, const char* operation, const segue::type::Value& arguments = {}) {
    const auto called = tasks_[id]->call(operation, arguments, soon());
    ASSERT_TRUE(called) << to_string(called.error());
  }

  segue::task::Task& task(const std::string& id) { return *tasks_[id]; }

  /// The next sample of a port.
  template <class T>
  T next(const std::string& id, const char* output) {
    segue::task::Component reader;
    segue::task::InputPort<T> port(reader, "port");
    const auto made = segue::sample_link::connect(*tasks_[id]->component().find_output(output), port, {});
    EXPECT_TRUE(made);
    T value{};
    for (int i = 0; i < 100 && port.read(value) != segue::task::ReadStatus::NewData; ++i)
      advance(std::chrono::milliseconds(10));
    return value;
  }

 private:
  segue::task_host::LibrarySet libraries_;
  segue::VirtualClock clock_;
  std::shared_ptr<segue::task::ManualExecutor> executor_ =
      std::make_shared<segue::task::ManualExecutor>(clock_);
  std::map<std::string, std::unique_ptr<segue::task::Task>> tasks_;
};

/// A leg of rover::VelocityScript.
inline segue::type::Value leg(double duration, double linear, double angular) {
  return segue::type::Value::map({{"duration", duration}, {"linear", linear}, {"angular", angular}});
}

}  // namespace rover::testing

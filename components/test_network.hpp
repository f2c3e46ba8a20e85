// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/virtual_clock.hpp>
#include <segue/sample_link/local.hpp>
#include <segue/task/component_registry.hpp>
#include <segue/task/manual_executor.hpp>
#include <segue/task/task.hpp>

#include <chrono>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

/// For tests only.
namespace components_test {

/// A network of tasks in virtual time, which runs in the thread of the test. Throws where something fails
/// that a test takes for granted.
class TestNetwork {
 public:
  ~TestNetwork() { tasks_.clear(); }

  segue::task::Task& add(const std::string& id, const std::string& component,
                         const segue::type::Value& properties = {}) {
    const auto entry = segue::task::find_component(component);
    if (!entry) throw std::runtime_error("no component " + component);
    auto made = checked(entry->create());
    const segue::Activity activity = made->options().activity;
    auto task = checked(segue::task::Task::create(id, std::move(made), activity, executor_));
    if (properties.is_map()) checked(task->set_properties(properties, soon()));
    return *(tasks_[id] = std::move(task));
  }
  segue::task::Task& task(const std::string& id) { return *tasks_.at(id); }
  segue::task::OutputPortBase& output(const std::string& id, const std::string& port) {
    return *found(task(id).component().find_output(port), id, port);
  }
  segue::task::InputPortBase& input(const std::string& id, const std::string& port) {
    return *found(task(id).component().find_input(port), id, port);
  }
  void connect(segue::task::OutputPortBase& from, segue::task::InputPortBase& to) {
    connections_.push_back(checked(segue::sample_link::connect(from, to, {})));
  }
  void start(const std::string& id) {
    checked(task(id).configure(soon()));
    checked(task(id).start(soon()));
  }
  void stop(const std::string& id) { checked(task(id).stop(soon())); }
  segue::Result<segue::type::Value> call(const std::string& id, const std::string& operation,
                                         const segue::type::Value& arguments = {}) {
    return task(id).call(operation, arguments, soon());
  }
  void advance(segue::Duration step) { executor_->advance(step); }
  void run_ready() { executor_->run_ready(); }
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(clock_.now().time_since_epoch()).count();
  }
  [[nodiscard]] static segue::TimePoint soon() {
    return segue::RealClock::instance().now() + std::chrono::seconds(60);
  }

 private:
  template <class T>
  static T checked(segue::Result<T> result) {
    if (!result) throw std::runtime_error(segue::to_string(result.error()));
    if constexpr (!std::is_void_v<T>) return std::move(*result);
  }
  template <class Port>
  static Port* found(Port* port, const std::string& id, const std::string& name) {
    if (port == nullptr) throw std::runtime_error("no port " + id + "." + name);
    return port;
  }

  segue::VirtualClock clock_;
  std::shared_ptr<segue::task::ManualExecutor> executor_ =
      std::make_shared<segue::task::ManualExecutor>(clock_);
  std::map<std::string, std::unique_ptr<segue::task::Task>> tasks_;
  std::vector<std::shared_ptr<segue::sample_link::PortConnection>> connections_;
};

}  // namespace components_test

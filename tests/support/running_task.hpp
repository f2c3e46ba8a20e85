// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/task/component_registry.hpp>
#include <segue/task/task.hpp>
#include <segue/type/value.hpp>

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>

namespace segue::testing {

inline TimePoint soon() {
  return RealClock::instance().now() + std::chrono::seconds(60);
}

/// A task of a registered component, with ports "in" or "out" and an operation "statistics".
class RunningTask {
 public:
  explicit RunningTask(const std::string& component, const std::string& id = "") {
    auto made = task::find_component(component)->create();
    auto created = task::Task::create(id.empty() ? component : id, std::move(*made));
    if (!created) std::abort();
    task_ = std::move(*created);
  }

  Result<void> configure(const type::ValueMap& values) {
    if (auto set = task_->set_properties(values, soon()); !set) return set;
    return task_->configure(soon());
  }
  /// Configures and starts; what fails is printed.
  void run(const type::ValueMap& values) {
    for (const auto& done : {configure(values), task_->start(soon())}) {
      if (!done) std::fprintf(stderr, "%s\n", to_string(done.error()).c_str());
    }
  }
  task::Task& task() { return *task_; }
  task::InputPortBase& in() { return *task_->component().find_input("in"); }
  task::OutputPortBase& out() { return *task_->component().find_output("out"); }

  /// One of the statistics.
  std::uint64_t count(const std::string& counter) {
    const auto all = task_->call("statistics", {}, soon());
    return all ? static_cast<std::uint64_t>(all->find(counter)->as_int()) : ~std::uint64_t{0};
  }

 private:
  std::unique_ptr<task::Task> task_;
};

}  // namespace segue::testing

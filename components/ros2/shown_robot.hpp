// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/mutex.hpp>
#include <segue/control/robot_service.hpp>
#include <segue/task_host/watches.hpp>

#include <support/fake_robot_service.hpp>

#include <atomic>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
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

  /// One with properties of all kinds, and with operations.
  void add_task(const std::string& id, const std::string& component = "demo::Drive") {
    const segue::Lock lock(mutex_);
    tasks_[id] = {component, segue::TaskState::Running, properties()};
    count_ += 1;
    watches_.ring();
  }
  void remove_task(const std::string& id) {
    const segue::Lock lock(mutex_);
    tasks_.erase(id);
    count_ += 1;
    watches_.ring();
  }
  void set_state(const std::string& id, segue::TaskState state) {
    const segue::Lock lock(mutex_);
    tasks_[id].state = state;
    watches_.ring();
  }
  /// Called with each property that is set, without a lock; its failure refuses that.
  std::function<Result<void>(const std::string& property)> on_set = [](const std::string&) {
    return Result<void>();
  };
  std::atomic<int> reports{0};  ///< that were asked for
  std::vector<segue::control::Sender> senders() {
    const segue::Lock lock(mutex_);
    return senders_;
  }
  Value property(const std::string& id, const std::string& name) {
    const segue::Lock lock(mutex_);
    return *tasks_[id].properties.find(name);
  }
  void log(const std::string& message, int lines = 1) {
    const segue::Lock lock(mutex_);
    for (int i = 0; i < lines; ++i) {
      lines_.push_back(Value::map({{"number", std::uint64_t{lines_.size() + 1}},
                                   {"time", segue::iso_time(std::chrono::system_clock::now())},
                                   {"level", "warning"},
                                   {"message", message}}));
    }
    told_.reset();
  }
  /// When the lines that there are have been told first.
  std::optional<segue::TimePoint> told() {
    const segue::Lock lock(mutex_);
    return told_;
  }

  Result<Value> status(const segue::Wait&) override {
    const segue::Lock lock(mutex_);
    Value::List all;
    for (const auto& [id, task] : tasks_)
      all.push_back(
          Value::map({{"id", id}, {"component", task.component}, {"state", to_string(task.state)}}));
    return Value::map({{"robot", "fake"}, {"tasks", Value(std::move(all))}});
  }
  Result<Value> task(std::string_view id, const segue::Wait&) override {
    ++reports;
    const segue::Lock lock(mutex_);
    const auto found = tasks_.find(id);
    if (found == tasks_.end()) return segue::fail(segue::ErrorCode::NotFound, "no such task runs");
    if (!told_) told_ = segue::monotonic_now();
    const auto operation = [](const char* name, Value::List arguments) {
      return Value::map({{"name", name}, {"arguments", Value(std::move(arguments))}});
    };
    return Value::map(
        {{"id", id},
         {"pid", 7},
         {"properties", found->second.properties},
         {"property_models", models()},
         {"operations", Value::list({operation("reset", {}), operation("push", {Value("far")})})},
         {"log", Value(lines_)}});
  }
  void watch(const segue::task_host::LevelQuestion& question, const segue::Wait& wait,
             segue::control::RobotLevelAnswer answered) override {
    watches_.add(wait, [this, question, answered](Watches::End end) {
      const segue::Lock lock(mutex_);
      const auto found = tasks_.find(question.task.str());
      if (end != Watches::End::No || found == tasks_.end()) {
        answered(segue::no_longer_wanted());
        return true;
      }
      const segue::task_host::TaskLevel level{found->second.state,
                                              std::string(to_string(found->second.state)), 0};
      if (!question.is_news(level)) return false;
      answered(segue::control::RobotLevel{level, count_});
      return true;
    });
  }
  void changes(std::uint64_t seen, const segue::Wait& wait, segue::control::ChangesAnswer answered) override {
    watches_.add(wait, [this, seen, answered](Watches::End end) {
      const segue::Lock lock(mutex_);
      if (end == Watches::End::No && count_ == seen) return false;
      answered(count_);
      return true;
    });
  }
  Result<void> set_property(std::string_view task, std::string_view property, const Value& value,
                            const segue::control::Sender& sender, const segue::Wait&) override {
    if (auto done = on_set(std::string(property)); !done) return done;
    const segue::Lock lock(mutex_);
    const auto found = tasks_.find(task);
    if (found == tasks_.end()) return segue::fail(segue::ErrorCode::NotFound, "no such task runs");
    senders_.push_back(sender);
    found->second.properties.as_map().set(std::string(property), value);
    return {};
  }
  Result<Value> call(std::string_view task, std::string_view operation, const Value&,
                     const segue::control::Sender&, const segue::Wait&) override {
    if (task != "drive") return segue::fail(segue::ErrorCode::HookFailed, "the wheels are stuck");
    return Value(std::string(operation) + " is done");
  }
  Result<Value> events(std::uint64_t after, const segue::Wait&) override {
    if (after > 0) return Value(Value::List());
    return Value::list({Value::map({{"number", 1},
                                    {"time", segue::iso_time(std::chrono::system_clock::now())},
                                    {"kind", "transition_done"},
                                    {"subject", "explore"},
                                    {"message", "runs"},
                                    {"trouble", true}})});
  }

 private:
  using Watches = segue::task_host::detail::Watches;
  struct Task {
    std::string component;
    segue::TaskState state = segue::TaskState::PreOperational;
    Value properties;
  };

  static Value properties() {
    return Value::map({{"speed", 0.5},
                       {"count", 3},
                       {"name", "left"},
                       {"on", true},
                       {"gains", Value::map({{"p", 1.5}, {"limits", Value::list({1, 2})}})},
                       {"offsets", Value(Value::List())},
                       {"points", Value::list({Value::map({{"x", 1.0}})})},
                       {"huge", ~std::uint64_t{0}}});
  }
  static Value models() {
    Value::List all;
    const Value values = properties();
    for (const auto& [name, value] : values.as_map()) {
      all.push_back(Value::map({{"name", name},
                                {"type", name == "offsets" ? "/std/vector</double>"
                                         : name == "count" ? "/std/chrono/milliseconds"
                                                           : "/any"},
                                {"default", Value()},
                                {"live", name != "count"},
                                {"doc", "the " + name}}));
    }
    return Value(std::move(all));
  }

  segue::Mutex mutex_;
  std::map<std::string, Task, std::less<>> tasks_ SEGUE_GUARDED_BY(mutex_);
  std::vector<segue::control::Sender> senders_ SEGUE_GUARDED_BY(mutex_);
  Value::List lines_ SEGUE_GUARDED_BY(mutex_);
  std::optional<segue::TimePoint> told_ SEGUE_GUARDED_BY(mutex_);
  std::uint64_t count_ SEGUE_GUARDED_BY(mutex_) = 1;
  Watches watches_;  ///< destroyed first: its questions use all others
};

}  // namespace ros2::testing

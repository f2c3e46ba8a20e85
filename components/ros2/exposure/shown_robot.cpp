// SPDX-License-Identifier: Apache-2.0
#include "shown_robot.hpp"

#include <chrono>
#include <utility>

namespace ros2::testing {

using segue::Lock;
using segue::Result;
using segue::type::Value;

namespace {

Value property_models() {
  Value::List all;
  const Value values = ShownRobot::properties();
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

Value operation_model(const char* name, Value::List arguments) {
  return Value::map({{"name", name}, {"arguments", Value(std::move(arguments))}});
}

std::string time_now() {
  return segue::iso_time(std::chrono::system_clock::now());
}

}  // namespace

ShownRobot::ShownRobot() {
  const Lock lock(mutex_);
  note("transition_done", "explore");
}

void ShownRobot::add_task(const std::string& id, const std::string& component) {
  const Lock lock(mutex_);
  tasks_[id] = {component, segue::TaskState::Running, properties()};
  count_ += 1;
  watches_.ring();
}

void ShownRobot::remove_task(const std::string& id) {
  const Lock lock(mutex_);
  tasks_.erase(id);
  count_ += 1;
  watches_.ring();
}

void ShownRobot::set_state(const std::string& id, segue::TaskState state) {
  const Lock lock(mutex_);
  tasks_[id].state = state;
  watches_.ring();
}

Value ShownRobot::properties() {
  return Value::map({{"speed", 0.5},
                     {"count", 3},
                     {"name", "left"},
                     {"on", true},
                     {"gains", Value::map({{"p", 1.5}, {"limits", Value::list({1, 2})}})},
                     {"offsets", Value(Value::List())},
                     {"points", Value::list({Value::map({{"x", 1.0}})})},
                     {"huge", ~std::uint64_t{0}}});
}

Value ShownRobot::property(const std::string& id, const std::string& name) {
  const Lock lock(mutex_);
  return *tasks_[id].properties.find(name);
}

void ShownRobot::change(const std::string& id, const std::string& property, const Value& value) {
  const Lock lock(mutex_);
  tasks_[id].properties.as_map().set(property, value);
  note("property", id);
}

void ShownRobot::configure(const std::string& id, const Value& properties) {
  const Lock lock(mutex_);
  note("transition_started", "explore");
  tasks_[id].properties = properties;
  note("transition_done", "explore");
}

void ShownRobot::silence(const std::string& id) {
  const Lock lock(mutex_);
  silent_task_ = id;
}

void ShownRobot::log(const std::string& message, int lines) {
  const Lock lock(mutex_);
  for (int i = 0; i < lines; ++i) {
    lines_.push_back(Value::map({{"number", std::uint64_t{lines_.size() + 1}},
                                 {"time", time_now()},
                                 {"level", "warning"},
                                 {"message", message}}));
  }
  told_.reset();
}

std::optional<segue::TimePoint> ShownRobot::told() {
  const Lock lock(mutex_);
  return told_;
}

void ShownRobot::forget_events() {
  const Lock lock(mutex_);
  events_.clear();
}

std::vector<segue::control::Sender> ShownRobot::senders() {
  const Lock lock(mutex_);
  return senders_;
}

Result<Value> ShownRobot::status(const segue::Wait&) {
  const Lock lock(mutex_);
  Value::List all;
  for (const auto& [id, task] : tasks_)
    all.push_back(Value::map({{"id", id}, {"component", task.component}, {"state", to_string(task.state)}}));
  return Value::map({{"robot", "fake"}, {"tasks", Value(std::move(all))}});
}

Result<Value> ShownRobot::task(std::string_view id, const segue::Wait&) {
  ++reports;
  bool is_silent = false;
  {
    const Lock lock(mutex_);
    is_silent = id == silent_task_;
  }
  if (is_silent) {
    entered.open();
    release.wait();
  }
  const Lock lock(mutex_);
  const auto found = tasks_.find(id);
  if (found == tasks_.end()) return segue::fail(segue::ErrorCode::NotFound, "no such task runs");
  if (!told_) told_ = segue::monotonic_now();
  return Value::map(
      {{"id", id},
       {"pid", 7},
       {"properties", found->second.properties},
       {"property_models", property_models()},
       {"operations", Value::list({operation_model("reset", {}), operation_model("push", {Value("far")})})},
       {"log", Value(lines_)}});
}

void ShownRobot::watch(const segue::task_host::LevelQuestion& question, const segue::Wait& wait,
                       segue::control::RobotLevelAnswer answered) {
  watches_.add(wait, [this, question, answered](Watches::End end) {
    const Lock lock(mutex_);
    const auto found = tasks_.find(question.task.str());
    if (end != Watches::End::No || found == tasks_.end()) {
      answered(segue::no_longer_wanted());
      return true;
    }
    const segue::task_host::TaskLevel level{found->second.state, std::string(to_string(found->second.state)),
                                            0};
    if (!question.is_news(level)) return false;
    answered(segue::control::RobotLevel{level, count_});
    return true;
  });
}

void ShownRobot::changes(std::uint64_t seen, const segue::Wait& wait,
                         segue::control::ChangesAnswer answered) {
  watches_.add(wait, [this, seen, answered](Watches::End end) {
    const Lock lock(mutex_);
    if (end == Watches::End::No && count_ == seen) return false;
    answered(count_);
    return true;
  });
}

Result<void> ShownRobot::set_property(std::string_view task, std::string_view property, const Value& value,
                                      const segue::control::Sender& sender, const segue::Wait&) {
  if (auto done = on_set(std::string(property)); !done) return done;
  const Lock lock(mutex_);
  const auto found = tasks_.find(task);
  if (found == tasks_.end()) return segue::fail(segue::ErrorCode::NotFound, "no such task runs");
  senders_.push_back(sender);
  found->second.properties.as_map().set(std::string(property), value);
  note("property", std::string(task));
  return {};
}

Result<Value> ShownRobot::call(std::string_view task, std::string_view operation, const Value&,
                               const segue::control::Sender&, const segue::Wait&) {
  if (task != "drive") return segue::fail(segue::ErrorCode::HookFailed, "the wheels are stuck");
  return Value(std::string(operation) + " is done");
}

Result<Value> ShownRobot::events(std::uint64_t after, const segue::Wait& wait) {
  ++event_looks;
  Lock lock(mutex_);
  noted_.wait_until(mutex_, wait.stop, wait.deadline,
                    [&]() SEGUE_REQUIRES(mutex_) { return last_event_ > after; });
  Value::List all;
  for (const Value& event : events_) {
    if (event.find("number")->as_int() > static_cast<std::int64_t>(after)) all.push_back(event);
  }
  return Value(std::move(all));
}

void ShownRobot::note(const std::string& kind, const std::string& subject) {
  events_.push_back(Value::map({{"number", ++last_event_},
                                {"time", time_now()},
                                {"kind", kind},
                                {"subject", subject},
                                {"message", "runs"},
                                {"trouble", true}}));
  noted_.notify_all();
}

}  // namespace ros2::testing

// SPDX-License-Identifier: Apache-2.0
#include "exposed_task.hpp"
#include "exposed_parameters.hpp"

#include <segue/base/text.hpp>
#include <segue/ros2/parameter_value.hpp>
#include <segue/type/json.hpp>

#include <chrono>
#include <utility>

namespace ros2 {

using segue::ErrorCode;
using segue::fail;
using segue::Result;
using segue::type::Value;

namespace {

/// How long the robot has for a request, however many properties that sets.
constexpr std::chrono::seconds kCarriedOutWithin{5};
constexpr std::chrono::seconds kUndoneWithin{2};

Value result_of(const Result<void>& done) {
  return Value::map(
      {{"successful", done.has_value()}, {"reason", done ? std::string() : segue::to_string(done.error())}});
}

}  // namespace

ExposedTask::ExposedTask(std::shared_ptr<segue::control::RobotService> robot, std::string id,
                         ExposureRules rules, std::stop_token stop)
    : robot_(std::move(robot)), id_(std::move(id)), rules_(std::move(rules)), stop_(std::move(stop)) {}

segue::control::Sender ExposedTask::sender() const {
  return {.who = rules_.who, .lease = 0, .beside_mission = false};
}

Value ExposedTask::report() const {
  auto report = robot_->task(id_, segue::Wait(segue::TimePoint::max(), stop_));
  if (report) return std::move(*report);
  if (report.error().code == ErrorCode::Cancelled) return {};
  rules_.log(segue::LogLevel::Warning,
             "task " + segue::quote(id_) + " cannot be asked: " + segue::to_string(report.error()));
  return {};
}

std::vector<std::string> ExposedTask::operations() const {
  std::vector<std::string> names;
  const Value task = report();
  const Value* all = task.find("operations");
  if (all == nullptr) return names;
  for (const Value& operation : all->as_list()) {
    if (operation.find("arguments")->as_list().empty()) names.push_back(operation.find("name")->as_string());
  }
  return names;
}

Value ExposedTask::describe(const Value& request) const {
  return describe_parameters(parameters_of(report()), request, rules_.writable);
}

Result<ExposedTask::Setting> ExposedTask::check(const Value& parameter, const Value& report) const {
  const std::string& name = parameter.find("name")->as_string();
  const std::string property = id_ + "." + name;
  if (!rules_.writable) {
    return fail(ErrorCode::PermissionDenied,
                "clients of ROS 2 may only look; set the property 'writable' of the task that exposes " +
                    segue::quote(id_) + ", or use `segue set " + property + "=VALUE`");
  }
  const auto all = parameters_of(report);
  const ExposedParameter* found = find_parameter(all, name);
  if (found == nullptr)
    return fail(ErrorCode::NotFound,
                "task " + segue::quote(id_) + " has no property " + segue::quote(name) + " now");
  if (!found->is_live) {
    return fail(ErrorCode::InvalidState, property +
                                             " is read when the task is configured; a switch does that: "
                                             "`segue switch CONTROLLER --set " +
                                             property + "=VALUE`");
  }
  Value value = segue::ros2::parameter_from(*parameter.find("value"));
  if (value.is_null()) return fail(ErrorCode::InvalidArgument, property + " cannot be undeclared");
  return Setting{name, std::move(value), segue::ros2::parameter_from(found->value)};
}

Result<void> ExposedTask::set(const std::string& name, const Value& value, segue::TimePoint deadline) {
  if (segue::monotonic_now() >= deadline)
    return fail(ErrorCode::DeadlineExceeded, "the request has taken too long already");
  return robot_->set_property(id_, name, value, sender(), segue::Wait(deadline, stop_));
}

Value ExposedTask::set_parameters(const Value& request) {
  const Value now = rules_.writable ? report() : Value();
  const segue::TimePoint end = segue::Deadline(kCarriedOutWithin);
  Value::List results;
  for (const Value& parameter : request.find("parameters")->as_list()) {
    const auto setting = check(parameter, now);
    results.push_back(result_of(setting ? set(setting->name, setting->value, end) : setting.error()));
  }
  return Value::map({{"results", Value(std::move(results))}});
}

/// All are looked at before the first one is set. What the robot refuses nevertheless is undone by setting
/// the earlier ones back.
Value ExposedTask::set_parameters_atomically(const Value& request) {
  const Value now = rules_.writable ? report() : Value();
  std::vector<Setting> settings;
  for (const Value& parameter : request.find("parameters")->as_list()) {
    auto setting = check(parameter, now);
    if (!setting) return Value::map({{"result", result_of(setting.error())}});
    settings.push_back(std::move(*setting));
  }
  const segue::TimePoint end = segue::Deadline(kCarriedOutWithin);
  for (std::size_t i = 0; i < settings.size(); ++i) {
    auto done = set(settings[i].name, settings[i].value, end);
    if (done) continue;
    std::string reason = segue::to_string(done.error());
    while (i-- > 0) {
      if (auto undone = set(settings[i].name, settings[i].before, end + kUndoneWithin); !undone)
        reason += "; " + settings[i].name + " cannot be set back: " + segue::to_string(undone.error());
    }
    return Value::map({{"result", Value::map({{"successful", false}, {"reason", std::move(reason)}})}});
  }
  return Value::map({{"result", result_of({})}});
}

Value ExposedTask::change_state(const Value&) {
  rules_.log(segue::LogLevel::Warning,
             "a client of ROS 2 asks for another state of task " + segue::quote(id_) +
                 ", which is refused: the robot's controller decides it; use `segue switch CONTROLLER`");
  return Value::map({{"success", false}});
}

Value ExposedTask::call(const std::string& operation) {
  const auto done =
      robot_->call(id_, operation, Value(), sender(), segue::Wait(segue::Deadline(kCarriedOutWithin), stop_));
  if (!done) return Value::map({{"success", false}, {"message", segue::to_string(done.error())}});
  return Value::map({{"success", true}, {"message", done->is_null() ? "" : segue::type::to_json(*done, -1)}});
}

}  // namespace ros2

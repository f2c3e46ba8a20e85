// SPDX-License-Identifier: Apache-2.0
#include "mission_remote.hpp"

#include <segue/concurrent/thread.hpp>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "../output.hpp"

namespace segue::cli {

namespace {

using mission_run::RunControl;
using type::Value;

/// The period in which a mission hears requests to it and reports what it does; it also reports as soon as it
/// has followed a request.
constexpr Duration kPeriod = std::chrono::milliseconds(100);

RunControl::Step step_called(const std::string& how) {
  return how == "into"   ? RunControl::Step::Into
         : how == "out"  ? RunControl::Step::Out
         : how == "back" ? RunControl::Step::Back
                         : RunControl::Step::Over;
}

Value::List list_of(const std::vector<std::string>& texts) {
  return {texts.begin(), texts.end()};
}

std::vector<std::string> texts_in(const Value::List& list) {
  std::vector<std::string> texts;
  for (const Value& one : list) {
    if (one.is_string()) texts.push_back(one.as_string());
  }
  return texts;
}

}  // namespace

void MissionRemote::Answers::heard(std::uint64_t number, const Result<void>& outcome) {
  const Lock lock(mutex_);
  note(number, outcome ? std::nullopt : std::optional(outcome.error()));
}

void MissionRemote::Answers::heard_values(std::uint64_t number, const std::string& path,
                                          const Result<Value>& values) {
  const Lock lock(mutex_);
  if (values) {
    values_ = *values;
    values_.as_map().set("number", number);
    values_.as_map().set("of", path);
  }
  note(number, values ? std::nullopt : std::optional(values.error()));
}

void MissionRemote::Answers::note(std::uint64_t number, const std::optional<Error>& refused) {
  heard_ = std::max(heard_, number);
  if (refused) problem_ = Value::map({{"number", number}, {"text", refused->message}});
  bell_.ring();
}

void MissionRemote::Answers::add_to(type::ValueMap& control) const {
  const Lock lock(mutex_);
  control.append("heard", heard_);
  if (!problem_.is_null()) control.append("problem", problem_);
  if (!values_.is_null()) control.append("values", values_);
}

MissionRemote::MissionRemote(remote_robot::ServedRobot& robot, const mission::Program& program, Plan plan,
                             std::string_view mode, RunControl& control, std::stop_source stop)
    : robot_(robot),
      mission_(program.mission().name),
      keeps_(program.mission().at_end == mission::Mission::AtEnd::Keep),
      halts_at_stop_(!keeps_ && !program.handles_preemption()),
      plan_(std::move(plan)),
      control_(control),
      stop_(std::move(stop)),
      stopping_(stop_.get_token(), Stopping{*answers_}) {
  robot_.record().began(mission_,
                        mode);  // before the thread reports the plan, which would else be that of no run
  thread_ =
      concurrent::start_stoppable_thread("segue-remote", [this](const std::stop_token& end) { work(end); });
}

void MissionRemote::ended(std::string_view outcome, std::string_view error) {
  robot_.record().ended(outcome, error);
}

void MissionRemote::observe(const mission::StateEvent& event) {
  robot_.record().observe(event);
  if (event.is_container) return;
  const Lock lock(mutex_);
  if (event.kind == mission::StateEvent::Kind::Began) {
    running_.emplace(event.path);
    return;
  }
  ++ended_;
  if (const auto found = running_.find(event.path); found != running_.end()) running_.erase(found);
}

/// A robot that cannot be reached any more ends the mission by the actions that need it.
void MissionRemote::work(const std::stop_token& end) {
  Value reported;
  do {
    if (const auto asked = robot_.asked()) {
      for (const control::HolderRequest& request : *asked)
        heed(request);
    }
    report(reported);
    (void)robot_.tell_units();  // until the robot has taken them
    answers_->bell().wait({RealClock::instance().now() + kPeriod, end});
  } while (!end.stop_requested());
  while (robot_.record().has_waiting()) {
    if (!robot_.report(doing())) break;
  }
  while (robot_.has_units_to_tell()) {
    if (const auto told = robot_.tell_units(); !told)
      return print_note("the robot has not been told all that became of its units: " + told.error().message);
  }
}

void MissionRemote::report(Value& reported) {
  Value now = doing();
  if (now == reported && !to_show_ && !robot_.record().has_waiting()) return;
  Value full = now;
  if (to_show_) full.as_map().set("plan", plan_(*to_show_));
  auto done = robot_.report(std::move(full));
  if (!done && done.error().code == ErrorCode::ResourceExhausted && to_show_) {
    full = now;
    full.as_map().set("plan", Value::map({{"problem", done.error().message}}));
    done = robot_.report(std::move(full));
  }
  if (!done) return;
  to_show_.reset();
  reported = std::move(now);
}

/// Where a run is asked, it answers when it has come to it.
void MissionRemote::heed(const control::HolderRequest& request) {
  const auto& [number, what, arguments] = request;
  const auto done = [answers = answers_, number = number](const Result<void>& outcome) {
    answers->heard(number, outcome);
  };
  if (what == "plan") {
    to_show_ = PlanDetail::Whole;
  } else if (what == "step") {
    control_.step(step_called(printable_at(arguments, "how")), done);
  } else if (what == "break") {
    control_.set_breakpoints(texts_in(list_at(arguments, "at")), done);
  } else if (what == "go_on_at") {
    control_.go_on_at(printable_at(arguments, "at"), done);
  } else if (what == "values") {
    const std::string path = printable_at(arguments, "of");
    control_.values_of(path, [answers = answers_, number = number, path](const Result<Value>& values) {
      answers->heard_values(number, path, values);
    });
  } else {
    if (what == "pause") control_.pause();
    if (what == "resume") control_.resume();
    if (what == "stop") stop_.request_stop();
    done({});
  }
}

/// The answers are looked at first, so that a reader which sees that a step was followed sees no position
/// from before it.
Value MissionRemote::steering() const {
  Value control = Value::map({});
  answers_->add_to(control.as_map());
  const RunControl::Position position = control_.position();
  control.as_map().append("steps", position.steps);
  control.as_map().append("back", position.back);
  control.as_map().append("at", position.at ? Value(list_of(*position.at)) : Value());
  control.as_map().append("breakpoints", list_of(position.breakpoints));
  return control;
}

Value MissionRemote::doing() const {
  Value control = steering();
  const Lock lock(mutex_);
  Value::List running;
  for (const std::string& path : running_)
    running.emplace_back(path);
  const char* state = stop_.stop_requested() ? "stopping" : control_.paused() ? "paused" : "running";
  return Value::map({{"mission", mission_},
                     {"state", state},
                     {"running", std::move(running)},
                     {"ended", ended_},
                     {"control", std::move(control)},
                     {"at_end", keeps_ ? "keep" : "halt"},
                     {"at_stop", halts_at_stop_ ? "halt" : "go_on"}});
}

}  // namespace segue::cli

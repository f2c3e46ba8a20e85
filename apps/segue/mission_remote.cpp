// SPDX-License-Identifier: Apache-2.0
#include "mission_remote.hpp"

#include <segue/base/text.hpp>

#include <fmt/core.h>

#include <condition_variable>
#include <memory>
#include <utility>
#include <vector>

#include "connection.hpp"
#include "output.hpp"

namespace segue::cli {

namespace {

using type::Value;

/// How often a mission reports what it does and hears what it shall do, and how often somebody looks whether
/// it has heard.
constexpr Duration kPeriod = std::chrono::milliseconds(100);

void wait(Duration duration, const std::stop_token& end = {}) {
  std::mutex mutex;
  std::unique_lock lock(mutex);
  std::condition_variable_any().wait_for(lock, end, duration, [] { return false; });
}

}  // namespace

MissionRemote::MissionRemote(robot::ServedRobot& robot, std::string mission, Plan plan,
                             session::PauseControl& pause, std::stop_source stop)
    : robot_(robot),
      mission_(std::move(mission)),
      plan_(std::move(plan)),
      pause_(pause),
      stop_(std::move(stop)),
      thread_([this](const std::stop_token& end) { work(end); }) {
  robot_.record().began(mission_);
}

void MissionRemote::ended(std::string_view outcome, std::string_view error) {
  robot_.record().ended(outcome, error);
}

void MissionRemote::observe(const mission::ActionEvent& event) {
  robot_.record().observe(event);
  const std::lock_guard lock(mutex_);
  if (event.kind == mission::ActionEvent::Kind::Began) {
    running_.emplace(event.path);
    return;
  }
  ++ended_;
  if (const auto found = running_.find(event.path); found != running_.end()) running_.erase(found);
}

/// A robot that cannot be reached any more ends the mission by the actions that need it.
void MissionRemote::work(const std::stop_token& end) {
  Value reported;
  while (!end.stop_requested()) {
    if (const auto asked = robot_.asked()) {
      for (const std::string& what : *asked)
        heed(what);
    }
    report(reported);
    wait(kPeriod, end);
  }
  while (robot_.record().has_waiting()) {
    if (!robot_.report(doing())) break;
  }
}

void MissionRemote::report(Value& reported) {
  Value now = doing();
  if (now == reported && !shall_show_plan_ && !robot_.record().has_waiting()) return;
  Value full = now;
  if (shall_show_plan_) full.as_map().set("plan", plan_());
  auto done = robot_.report(std::move(full));
  if (!done && done.error().code == ErrorCode::ResourceExhausted && shall_show_plan_) {
    full = now;
    full.as_map().set("plan", Value::map({{"problem", done.error().message}}));
    done = robot_.report(std::move(full));
  }
  if (!done) return;
  shall_show_plan_ = false;
  reported = std::move(now);
}

void MissionRemote::heed(const std::string& what) {
  if (what == "pause") pause_.pause();
  if (what == "resume") pause_.resume();
  if (what == "stop") stop_.request_stop();
  if (what == "plan") shall_show_plan_ = true;
}

Value MissionRemote::doing() const {
  const std::lock_guard lock(mutex_);
  Value::List running;
  for (const std::string& path : running_)
    running.emplace_back(path);
  const char* state = stop_.stop_requested() ? "stopping" : pause_.paused() ? "paused" : "running";
  return Value::map(
      {{"mission", mission_}, {"state", state}, {"running", std::move(running)}, {"ended", ended_}});
}

namespace {

struct RemoteOptions {
  Duration timeout = std::chrono::seconds(10);
};

/// What the mission that commands the robot is doing. NotFound where none does.
Result<Value> mission_of(control::RobotService& robot) {
  auto status = robot.status();
  if (!status) return status.error();
  const Value* doing = status->find("doing");
  if (doing != nullptr && doing->find("mission") != nullptr) return *doing;
  const std::string who = text_at(*status, "commanded_by");
  return fail(ErrorCode::NotFound, who.empty()
                                       ? std::string("no mission commands the robot")
                                       : "the robot is commanded by " + who + ", which is no mission");
}

int show_mission(control::RobotService& robot, const Context& context) {
  const auto doing = mission_of(robot);
  if (!doing) return failed(context, doing.error());
  if (context.json()) {
    print_json(*doing);
    return kDone;
  }
  std::vector<std::string> running;
  for (const Value& path : list_at(*doing, "running"))
    running.push_back(path.is_string() ? path.as_string() : "");
  const auto ended = number_at(*doing, "ended");
  print_line(printable(fmt::format("mission {}: {}; {}; {} action{} ended", text_at(*doing, "mission"),
                                   text_at(*doing, "state"),
                                   running.empty() ? "nothing is under way" : "under way: " + listed(running),
                                   ended, ended == 1 ? " has" : "s have")));
  return kDone;
}

/// Until the mission is as wanted; a mission that has ended is stopped.
int ask_mission(control::RobotService& robot, const std::string& what, const std::string& wanted,
                const RemoteOptions& options, const Context& context) {
  auto doing = mission_of(robot);
  if (!doing) return failed(context, doing.error());
  const std::string name = text_at(*doing, "mission");
  if (auto asked = robot.ask_holder(what); !asked) return failed(context, asked.error());
  const TimePoint deadline = deadline_in(options.timeout);
  while (doing && text_at(*doing, "state") != wanted) {
    if (RealClock::instance().now() > deadline) {
      return failed(context, fail(ErrorCode::DeadlineExceeded, "mission " + quote(name) + " is still " +
                                                                   text_at(*doing, "state") +
                                                                   "; watch it with 'segue mission status'"));
    }
    wait(kPeriod);
    doing = mission_of(robot);
  }
  const bool has_ended = !doing && doing.error().code == ErrorCode::NotFound;
  if (!doing && (!has_ended || what != "stop")) return failed(context, doing.error());
  const std::string state = has_ended ? "stopped" : text_at(*doing, "state");
  if (context.json()) {
    print_json(Value::map({{"mission", name}, {"state", state}}));
  } else {
    print_line(printable(fmt::format("mission {}: {}", name, state)));
  }
  return kDone;
}

void add_request(Verb& mission, Context& context, const char* what, const char* wanted, const char* help) {
  const auto options = std::make_shared<RemoteOptions>();
  Verb& verb = add_verb(mission, context, what, help, fmt::format("  segue mission {}", what),
                        [what, wanted, options, &context] {
                          return with_robot(context, [&](control::RobotService& robot) {
                            return ask_mission(robot, what, wanted, *options, context);
                          });
                        });
  verb.option("--timeout DURATION", options->timeout, "how long to wait until it is (default 10s)");
  add_robot_option(verb, context);
}

}  // namespace

void add_mission_remote(Verb& mission, Context& context) {
  Verb& status = add_verb(mission, context, "status", "show what the mission that commands a robot is doing",
                          "  segue mission status", [&context] {
                            return with_robot(context, [&](control::RobotService& robot) {
                              return show_mission(robot, context);
                            });
                          });
  add_robot_option(status, context);
  add_request(mission, context, "pause", "paused",
              "let the mission that commands a robot begin nothing more; what is under way goes on");
  add_request(mission, context, "resume", "running", "let a paused mission go on");
  add_request(mission, context, "stop", "ended",
              "stop the mission that commands a robot: what is under way is preempted");
}

}  // namespace segue::cli

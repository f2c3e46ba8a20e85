// SPDX-License-Identifier: Apache-2.0
#include "robot_log.hpp"

#include <segue/base/condition_variable.hpp>
#include <segue/concurrent/thread.hpp>

#include <ctime>
#include <string_view>

namespace ros2 {

using segue::LogLevel;
using segue::type::Value;
using LogTime = std::chrono::system_clock::time_point;

namespace {

/// How often the robot is asked.
constexpr std::chrono::seconds kLogPeriod{1};
/// Between two lines, of the first ones of each look: what came in a second is told at once, and `ros2 topic
/// echo` keeps only five samples that it has not printed.
constexpr std::chrono::milliseconds kBetweenLines{5};
constexpr std::size_t kMostSpaced = 100;
/// Older lines would have left /rosout already.
constexpr std::chrono::seconds kLineAge{10};

/// The inverse of segue::iso_time(); now where it is none.
LogTime log_time(const std::string& text) {
  std::tm parts{};
  const char* rest = ::strptime(text.c_str(), "%Y-%m-%dT%H:%M:%S", &parts);
  if (rest == nullptr) return std::chrono::system_clock::now();
  int milliseconds = 0;
  if (std::string_view(rest).size() >= 4 && *rest == '.') {
    for (int i = 1; i <= 3; ++i)
      milliseconds = 10 * milliseconds + (rest[i] - '0');
  }
  return std::chrono::system_clock::from_time_t(::timegm(&parts)) + std::chrono::milliseconds(milliseconds);
}

LogLevel log_level(std::string_view text) {
  for (const LogLevel level : {LogLevel::Debug, LogLevel::Warning, LogLevel::Error}) {
    if (segue::to_string(level) == text) return level;
  }
  return LogLevel::Info;
}

/// Less, where it is stopped.
void pause_for(std::chrono::milliseconds time, const std::stop_token& stop) {
  segue::Mutex mutex;
  segue::StoppableConditionVariable never;
  const segue::Lock lock(mutex);
  never.wait_for(mutex, stop, time, [] { return false; });
}

}  // namespace

RobotLog::RobotLog(std::shared_ptr<segue::control::RobotService> robot, std::shared_ptr<Rosout> rosout,
                   std::string own_node, std::function<ShownNodes()> nodes)
    : robot_(std::move(robot)),
      rosout_(std::move(rosout)),
      own_node_(std::move(own_node)),
      nodes_(std::move(nodes)),
      thread_(segue::concurrent::start_stoppable_thread(
          "segue-rosout", [this](const std::stop_token& stop) { run(stop); })) {}

void RobotLog::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    if (rosout_->is_read())
      publish_all(stop);
    else
      since_ = std::chrono::system_clock::now() - kLineAge;
    pause_for(kLogPeriod, stop);
  }
}

void RobotLog::publish_all(const std::stop_token& stop) {
  spaced_ = 0;
  publish_events(stop);
  const ShownNodes nodes = nodes_();
  std::erase_if(last_, [&](const auto& one) { return !nodes.contains(one.first); });
  for (const auto& [task, node] : nodes) {
    if (stop.stop_requested()) return;
    publish_lines(task, node.name, stop);
  }
}

void RobotLog::publish_events(const std::stop_token& stop) {
  const auto events = robot_->events(last_event_, segue::Wait(segue::monotonic_now(), stop));
  if (!events) return;
  for (const Value& event : events->as_list()) {
    last_event_ = number_of(event);
    const LogTime time = log_time(event.find("time")->as_string());
    if (time < since_) continue;
    const LogLevel level = *event.find("trouble") == Value(true) ? LogLevel::Warning : LogLevel::Info;
    publish({time, level, logger_of(own_node_),
             event.find("subject")->as_string() + ": " + event.find("message")->as_string()},
            stop);
  }
}

void RobotLog::publish_lines(const std::string& task, const std::string& node, const std::stop_token& stop) {
  const auto report = robot_->task(task, segue::Wait(segue::TimePoint::max(), stop));
  const Value* log = report ? report->find("log") : nullptr;
  if (log == nullptr) return;
  Position& last = last_[task];
  const Value* pid = report->find("pid");
  if (pid != nullptr && pid->is_integer() && pid->as_int() != last.pid) last = {pid->as_int(), 0};
  for (const Value& line : log->as_list()) {
    if (number_of(line) <= last.number) continue;
    last.number = number_of(line);
    const LogTime time = log_time(line.find("time")->as_string());
    if (time < since_) continue;
    publish({time, log_level(line.find("level")->as_string()), logger_of(node),
             line.find("message")->as_string()},
            stop);
  }
}

std::uint64_t number_of(const Value& line) {
  const Value* number = line.find("number");
  return number == nullptr || number->kind() != Value::Kind::Int
             ? 0
             : static_cast<std::uint64_t>(number->as_int());
}

void RobotLog::publish(const Rosout::Line& line, const std::stop_token& stop) {
  rosout_->publish(line);
  if (++spaced_ <= kMostSpaced) pause_for(kBetweenLines, stop);
}

}  // namespace ros2

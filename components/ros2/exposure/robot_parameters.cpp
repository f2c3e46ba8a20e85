// SPDX-License-Identifier: Apache-2.0
#include "robot_parameters.hpp"
#include "robot_log.hpp"

#include <segue/concurrent/thread.hpp>

#include <chrono>
#include <string_view>
#include <utility>

namespace ros2 {

using segue::Deadline;
using segue::ErrorCode;
using segue::Wait;
using segue::type::Value;

namespace {

/// A task that does not answer holds up what is told of others.
constexpr std::chrono::seconds kReportWithin{2};
/// Until whoever has not answered is asked again.
constexpr std::chrono::seconds kAskAgain{2};
constexpr std::chrono::minutes kLongWait{1};

/// Whether the properties of all tasks may be others after an event of that kind.
bool changes_tasks(std::string_view kind) {
  return kind.starts_with("transition_") && kind != "transition_started";
}

}  // namespace

RobotParameters::RobotParameters(std::shared_ptr<segue::control::RobotService> robot,
                                 std::shared_ptr<MessageWriter> topic, std::function<ShownNodes()> nodes)
    : robot_(std::move(robot)),
      topic_(std::move(topic)),
      nodes_(std::move(nodes)),
      were_read_(topic_->is_read()),
      thread_(segue::concurrent::start_stoppable_thread("segue-parameter",
                                                        [this](const std::stop_token& stop) { run(stop); })) {
  topic_->watch([this] { look(); });
  look();
}

RobotParameters::~RobotParameters() {
  topic_->watch(nullptr);
}

void RobotParameters::look() {
  std::stop_source wait;
  {
    const segue::Lock lock(mutex_);
    has_changed_ = true;
    wait = wait_;
  }
  changed_.notify_all();
  wait.request_stop();
}

std::optional<std::stop_token> RobotParameters::next_wait() {
  const segue::Lock lock(mutex_);
  if (std::exchange(has_changed_, false)) return {};
  wait_ = std::stop_source();
  return wait_.get_token();
}

void RobotParameters::pause(const std::stop_token& stop) {
  segue::Lock lock(mutex_);
  changed_.wait_for(mutex_, stop, kAskAgain, [this]() SEGUE_REQUIRES(mutex_) { return has_changed_; });
}

void RobotParameters::run(const std::stop_token& stop) {
  const std::stop_callback ended(stop, [this] { look(); });
  while (!stop.stop_requested()) {
    {
      segue::Lock lock(mutex_);
      changed_.wait(mutex_, stop, [this] { return topic_->is_read(); });
    }
    follow(stop);
    known_.clear();
    were_read_ = false;
  }
}

void RobotParameters::follow(const std::stop_token& stop) {
  // Answers of tasks from here on are not older than the events that are not known yet.
  if (const auto events = robot_->events(last_event_, Wait(segue::monotonic_now(), stop)))
    take_events(*events);
  take_nodes(were_read_);
  while (!stop.stop_requested() && topic_->is_read()) {
    take_nodes(true);
    const bool all_have_answered = ask_tasks(stop);
    const auto looked = next_wait();
    if (!looked) continue;
    const Deadline until = all_have_answered ? Deadline(kLongWait) : Deadline(kAskAgain);
    const auto events = robot_->events(last_event_, Wait(until, *looked));
    if (events)
      take_events(*events);
    else if (events.error().code != ErrorCode::Cancelled)
      pause(stop);
  }
}

void RobotParameters::take_nodes(bool are_new) {
  const ShownNodes nodes = nodes_();
  std::erase_if(known_, [&](const auto& one) {
    const auto found = nodes.find(one.first);
    return found == nodes.end() || found->second.number != one.second.number;
  });
  for (const auto& [task, node] : nodes)
    known_.try_emplace(task, Known{node.name, node.number, are_new});
}

bool RobotParameters::ask_tasks(const std::stop_token& stop) {
  bool all_have_answered = true;
  for (auto& [task, known] : known_) {
    if (!known.has_to_be_asked || stop.stop_requested()) continue;
    const auto report = robot_->task(task, Wait(Deadline(kReportWithin), stop));
    known.has_to_be_asked = !report && report.error().code != ErrorCode::NotFound;
    if (report) tell(known, *report);
    all_have_answered = all_have_answered && !known.has_to_be_asked;
  }
  return all_have_answered;
}

void RobotParameters::tell(Known& known, const Value& report) const {
  auto now = parameters_of(report);
  const bool is_known = known.told || known.is_new;
  const std::vector<ExposedParameter> before =
      std::exchange(known.told, now).value_or(std::vector<ExposedParameter>());
  auto event = is_known ? parameter_event(before, now) : std::nullopt;
  if (!event) return;
  event->as_map().set("stamp", time_message(std::chrono::system_clock::now()));
  event->as_map().set("node", known.node);
  topic_->publish(*event);
}

void RobotParameters::take_events(const Value& events) {
  for (const Value& event : events.as_list()) {
    const std::uint64_t number = number_of(event);
    const bool some_are_lost = number > last_event_ + 1;
    const std::string& kind = event.find("kind")->as_string();
    const std::string& subject = event.find("subject")->as_string();
    last_event_ = number;
    for (auto& [task, known] : known_) {
      if (some_are_lost || changes_tasks(kind) || (kind == "property" && subject == task))
        known.has_to_be_asked = true;
    }
  }
}

}  // namespace ros2

// SPDX-License-Identifier: Apache-2.0
#include <segue/base/mutex.hpp>
#include <segue/base/question.hpp>
#include <segue/base/text.hpp>
#include <segue/mission_robot/robot_poll.hpp>

#include <algorithm>

namespace segue::mission {

namespace {

/// Whoever has samples may need a moment to say that none has come.
constexpr Duration kGrace = std::chrono::milliseconds(100);

}  // namespace

Result<PortFeed> PortFeed::open(CommandedRobot& robot, const Member& port, const Wait& wait) {
  auto samples = robot.open(port, wait);
  if (!samples) return samples.error();
  return PortFeed{port, std::move(*samples)};
}

Result<void> open_feeds(CommandedRobot& robot, const std::vector<OutputSource>& sources,
                        std::vector<std::optional<PortFeed>>& feeds, const Wait& wait) {
  feeds.resize(sources.size());
  for (std::size_t i = 0; i < feeds.size(); ++i) {
    if (feeds[i]) continue;
    auto opened = PortFeed::open(robot, sources[i].port, wait);
    if (!opened) return opened.error();
    feeds[i] = std::move(*opened);
  }
  return {};
}

Result<void> PortFeed::poll(const Wait& wait) {
  return take_in(samples->take(wait));
}

Result<void> PortFeed::next(const Wait& wait) {
  const Wait patient(std::min(wait.deadline, TimePoint::max() - kGrace) + kGrace, wait.stop);
  auto came = answer_to<std::vector<type::Value>>(patient, [&](const Wait& asked, SamplesAnswer answer) {
    samples->next(Wait(wait.deadline, asked.stop), std::move(answer));
  });
  const bool is_late = !came && came.error().code == ErrorCode::DeadlineExceeded;
  return take_in(is_late ? std::vector<type::Value>() : std::move(came));
}

Result<void> PortFeed::take_in(Result<std::vector<type::Value>> came) {
  if (!came) return came.error();
  fresh = std::move(*came);
  if (!fresh.empty()) last = fresh.back();
  return {};
}

std::string sentence(const EndCondition& condition) {
  if (const auto* time = std::get_if<TimeIsUp>(&condition.when))
    return "it had not ended after " + format_duration(time->after);
  return model::sentence(std::get<RobotCondition>(condition.when));
}

bool may_be_lost(const Error& error) {
  return error.code == ErrorCode::NotFound || error.code == ErrorCode::Unavailable;
}

bool is_in(const TaskView& task, const TaskReaches& state) {
  return task.state == state.state || task.state_name == state.state;
}

Result<bool> holds(CommandedRobot& robot, const OperationAnswers& when, const Wait& wait) {
  const auto answer = robot.call(when.operation, type::ValueMap{}, wait);
  if (!answer) return answer.error();
  return *answer == when.is;
}

std::optional<Ending> ending_by(const ControllerTrouble& trouble, const std::string& controller,
                                const std::function<bool(const std::string& task)>& awaits) {
  const auto lost = [&](const std::string& why) {
    return Ending{kAborted, "controller " + quote(controller) + " was lost: " + why};
  };
  if (!trouble.why.empty()) return lost(trouble.why);
  for (const ControllerTrouble::Task& task : trouble.tasks) {
    if (!awaits || !awaits(task.id)) return lost(task.why);
  }
  return std::nullopt;
}

void wait_for_next_poll(Duration period, const std::stop_token& stop) {
  Mutex mutex;
  Lock lock(mutex);
  StoppableConditionVariable().wait_for(mutex, stop, period, []() SEGUE_REQUIRES(mutex) { return false; });
}

}  // namespace segue::mission

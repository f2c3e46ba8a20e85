// SPDX-License-Identifier: Apache-2.0
#include "remote_action.hpp"

#include <segue/base/clock.hpp>
#include <segue/concurrent/thread.hpp>

#include <algorithm>
#include <chrono>
#include <functional>
#include <utility>

namespace ros2 {
namespace {

using segue::ErrorCode;
using segue::fail;
using segue::type::Value;

/// How long a server that has come back, or is slow, is waited for.
constexpr std::chrono::seconds kComesBack{60};

}  // namespace

segue::Result<std::unique_ptr<RemoteAction>> RemoteAction::make(std::shared_ptr<Participant> participant,
                                                                segue::ros2::InterfaceLibrary& library,
                                                                const std::string& action,
                                                                const std::string& interface,
                                                                GoalListener& listener) {
  auto messages = ActionMessages::of(library, action, interface);
  if (!messages) return messages.error();
  std::unique_ptr<RemoteAction> made(
      new RemoteAction(std::move(participant), std::move(*messages), listener));
  if (auto opened = made->open(library); !opened) return opened.error();
  return made;
}

RemoteAction::RemoteAction(std::shared_ptr<Participant> participant, ActionMessages messages,
                           GoalListener& listener)
    : participant_(std::move(participant)),
      messages_(std::move(messages)),
      action_(messages_.action),
      listener_(listener) {}

RemoteAction::~RemoteAction() {
  participant_->stop_watching(this);
}

segue::Result<void> RemoteAction::open(segue::ros2::InterfaceLibrary& library) {
  struct Part {
    std::unique_ptr<Requester>& requester;
    ActionMessages::Service service;
  };
  for (const Part& part :
       {Part{send_goal_, messages_.send_goal()}, Part{cancel_goal_, messages_.cancel_goal()},
        Part{get_result_, messages_.get_result()}}) {
    auto made = Requester::make(participant_, library, part.service.name, part.service.interface);
    if (!made) return made.error();
    part.requester = std::move(*made);
  }
  feedback_in_ = std::make_unique<MessageReader>([this](auto bytes) { take_feedback(bytes); });
  status_in_ = std::make_unique<MessageReader>([this](auto bytes) { take_status(bytes); });
  if (auto opened =
          feedback_in_->open(*participant_, messages_.feedback_topic(), messages_.feedback_message, {});
      !opened)
    return opened;
  if (auto opened = status_in_->open(*participant_, messages_.status_topic(), messages_.status,
                                     ActionMessages::status_quality());
      !opened)
    return opened;
  participant_->watch(this, [this] { look_for_server(); });
  return {};
}

std::vector<segue::ros2::Gid> RemoteAction::publishers() const {
  return {send_goal_->publisher(), cancel_goal_->publisher(), get_result_->publisher()};
}

std::vector<segue::ros2::Gid> RemoteAction::subscriptions() const {
  return {send_goal_->subscription(), cancel_goal_->subscription(), get_result_->subscription(),
          feedback_in_->gid(), status_in_->gid()};
}

Value RemoteAction::cancel_request(const GoalId& id) {
  return Value::map({{"goal_info", goal_id_value(id)}});
}

void RemoteAction::start() {
  for (Requester* requester : {send_goal_.get(), cancel_goal_.get(), get_result_.get()})
    requester->allow(true);
  {
    const segue::Lock lock(mutex_);
    goal_.reset();
    takes_goals_ = true;
    sends_put_off_ = true;
  }
  sender_ = segue::concurrent::start_thread("segue-goal", [this] { send_put_off(); });
}

segue::Result<void> RemoteAction::stop(segue::TimePoint deadline) {
  {
    const segue::Lock lock(mutex_);
    takes_goals_ = false;
    changed_.notify_all();
  }
  auto ended = end_goal(deadline);
  for (Requester* requester : {send_goal_.get(), cancel_goal_.get(), get_result_.get()})
    requester->allow(false);
  {
    const segue::Lock lock(mutex_);
    goal_.reset();
    put_off_.clear();
    sends_put_off_ = false;
    changed_.notify_all();
  }
  sender_.join();
  return ended;
}

void RemoteAction::send_put_off() {
  segue::Lock lock(mutex_);
  while (true) {
    changed_.wait(mutex_, [&]() SEGUE_REQUIRES(mutex_) { return !sends_put_off_ || !put_off_.empty(); });
    if (!sends_put_off_) return;
    const PutOff next = put_off_.front();
    put_off_.pop_front();
    lock.unlock();
    const segue::TimePoint deadline = segue::monotonic_now() + kComesBack;
    next.cancels ? ask_to_cancel(next.id, deadline) : ask_for_result(next.id, deadline);
    lock.lock();
  }
}

segue::Result<void> RemoteAction::end_goal(segue::TimePoint deadline) {
  segue::Lock lock(mutex_);
  if (!goal_) return {};
  // One that has been sent is accepted or refused first: a server does not cancel what it does not know.
  const segue::TimePoint now = segue::monotonic_now();
  changed_.wait_until(mutex_, now + (deadline - now) / 2,
                      [&]() SEGUE_REQUIRES(mutex_) { return goal_->state != GoalState::Asked; });
  const Goal goal = *goal_;
  lock.unlock();
  if (goal.is_given_up) ask_to_cancel(goal.id, now);
  if (!is_active(goal.state)) return {};
  if (auto agreed = cancel(goal.id, deadline); !agreed) return agreed;
  lock.lock();
  const bool ended = changed_.wait_until(
      mutex_, deadline, [&]() SEGUE_REQUIRES(mutex_) { return !goal_ || !is_active(goal_->state); });
  if (ended) return {};
  return fail(ErrorCode::DeadlineExceeded,
              "the server of action " + action_ + " cancels the goal, but has not ended it in time");
}

segue::Result<void> RemoteAction::await_server(segue::TimePoint deadline) {
  for (Requester* requester : {send_goal_.get(), cancel_goal_.get(), get_result_.get()}) {
    if (auto there = requester->await_server(deadline); !there) {
      if (there.error().code != ErrorCode::Unavailable) return there;
      return fail(ErrorCode::Unavailable, "action " + action_ + " has no server");
    }
    if (requester->servers() > 1) {
      return fail(ErrorCode::InvalidState, "action " + action_ + " has " +
                                               std::to_string(requester->servers()) +
                                               " servers, which would all do it: end all but one");
    }
  }
  return {};
}

std::optional<GoalId> RemoteAction::replace_goal(const GoalId& id) {
  const segue::Lock lock(mutex_);
  std::optional<GoalId> earlier;
  if (goal_ && is_active(goal_->state)) earlier = goal_->id;
  goal_ = Goal{.id = id};
  listener_.goal_changed(GoalState::Asked);
  changed_.notify_all();
  return earlier;
}

segue::Result<bool> RemoteAction::send(const Value& goal, segue::TimePoint deadline) {
  if (auto fits = messages_.goal.encode(goal, "goal"); !fits) return fits.error();
  if (auto there = await_server(deadline); !there) return there.error();
  {
    const segue::Lock lock(mutex_);
    if (!takes_goals_)
      return fail(ErrorCode::Cancelled, "action " + action_ + " gets no goal: the task stops");
  }
  const GoalId id = random_gid();
  const auto earlier = replace_goal(id);
  Value request = goal_id_value(id);
  request.as_map().append("goal", goal);
  if (auto sent = send_goal_->begin(request, deadline, [this, id](const auto& got) { take_answer(id, got); });
      !sent) {
    if (earlier) ask_to_cancel(*earlier, deadline);
    const segue::Lock lock(mutex_);
    if (current(id) != nullptr) change(GoalState::Lost);
    return sent.error();
  }
  auto answered = await_answer(id, deadline);
  // Some servers have ended it themselves, since they have one goal at a time.
  if (earlier) ask_to_cancel(*earlier, deadline);
  if (answered && *answered) ask_for_result(id, deadline);
  return answered;
}

segue::Result<bool> RemoteAction::await_answer(const GoalId& id, segue::TimePoint deadline) {
  const segue::Lock lock(mutex_);
  changed_.wait_until(mutex_, deadline, [&]() SEGUE_REQUIRES(mutex_) {
    return !takes_goals_ || current(id) == nullptr || current(id)->state != GoalState::Asked;
  });
  Goal* goal = current(id);
  if (goal == nullptr) return fail(ErrorCode::Cancelled, "another goal has taken its place");
  if (goal->state == GoalState::Refused) return false;
  if (goal->state == GoalState::Lost) {
    return fail(ErrorCode::Unavailable,
                "the server of action " + action_ +
                    (goal->is_unseen ? " has left" : " has not answered with a message of its type") +
                    "; whether it does it is not known");
  }
  if (goal->state != GoalState::Asked) return true;
  if (!takes_goals_) return fail(ErrorCode::Cancelled, "the task stops");
  goal->is_given_up = true;
  change(GoalState::Lost);
  return fail(ErrorCode::DeadlineExceeded, "the server of action " + action_ +
                                               " has not answered in time; the goal is canceled if it is "
                                               "accepted later");
}

void RemoteAction::ask_for_result(const GoalId& id, segue::TimePoint deadline) {
  auto asked =
      get_result_->begin(goal_id_value(id), deadline, [this, id](const auto& got) { take_result(id, got); });
  if (asked) return;
  const segue::Lock lock(mutex_);
  if (current(id) == nullptr) return;
  listener_.goal_trouble("the result cannot be asked for: " + segue::to_string(asked.error()));
  lose_sight();
}

void RemoteAction::ask_to_cancel(const GoalId& id, segue::TimePoint deadline) {
  auto asked = cancel_goal_->begin(cancel_request(id), deadline, [](const auto&) {});
  if (asked || asked.error().code == ErrorCode::Cancelled) return;
  const segue::Lock lock(mutex_);
  listener_.goal_trouble("a goal that is not wanted any more may go on: " + segue::to_string(asked.error()));
}

segue::Result<void> RemoteAction::cancel(segue::TimePoint deadline) {
  segue::Lock lock(mutex_);
  if (!goal_ || !is_active(goal_->state))
    return fail(ErrorCode::InvalidState, "action " + action_ + " has no goal that could be canceled");
  const GoalId id = goal_->id;
  lock.unlock();
  return cancel(id, deadline);
}

segue::Result<void> RemoteAction::cancel(const GoalId& id, segue::TimePoint deadline) {
  auto response = cancel_goal_->call(cancel_request(id), deadline);
  if (!response) return response.error();
  const auto code = static_cast<CancelCode>(response->find("return_code")->as_int());
  if (code == CancelCode::Agrees || code == CancelCode::HasEnded) return {};
  return fail(ErrorCode::InvalidState,
              "the server of action " + action_ +
                  (code == CancelCode::Refuses ? " refuses to cancel the goal" : " does not know the goal"));
}

void RemoteAction::take_answer(const GoalId& id, const segue::Result<Value>& answer) {
  const bool accepted = answer && answer->find("accepted")->as_bool();
  const segue::Lock lock(mutex_);
  const Goal* goal = current(id);
  if (goal == nullptr || goal->is_given_up) {
    if (accepted) put_off_.push_back({id, true});
    changed_.notify_all();
    return;
  }
  // Its status, if it has come, is newer.
  if (goal->state != GoalState::Asked) return;
  if (!answer) listener_.goal_trouble(segue::to_string(answer.error()));
  change(!answer ? GoalState::Lost : accepted ? GoalState::Accepted : GoalState::Refused);
}

void RemoteAction::take_result(const GoalId& id, const segue::Result<Value>& answer) {
  const segue::Lock lock(mutex_);
  const Goal* goal = current(id);
  if (goal == nullptr || (!is_active(goal->state) && goal->state != GoalState::Lost)) return;
  if (!answer) {
    listener_.goal_trouble(segue::to_string(answer.error()));
    return change(GoalState::Lost);
  }
  const auto status = answer->find("status")->as_int();
  if (status < std::int64_t{static_cast<std::uint8_t>(GoalState::Succeeded)} ||
      status > std::int64_t{static_cast<std::uint8_t>(GoalState::Aborted)}) {
    listener_.goal_trouble("the server of action " + action_ + " has no result of the goal");
    return change(GoalState::Lost);
  }
  // Its place in the response differs from that in a message of its own.
  if (const auto result = messages_.result.encode(*answer->find("result"), "result"); result) {
    listener_.result_came(*result);
  } else {
    listener_.goal_trouble(segue::to_string(result.error()));
  }
  change(static_cast<GoalState>(status));
}

void RemoteAction::take_feedback(std::span<const std::byte> message) {
  const segue::Lock lock(mutex_);
  if (!goal_ || !is_active(goal_->state)) return;
  const auto id = split_goal_id(message, feedback_bytes_);
  if (id && *id != goal_->id) return;
  listener_.feedback_came(feedback_bytes_);
}

void RemoteAction::take_status(std::span<const std::byte> message) {
  const auto all = messages_.status.decode(message);
  if (!all) return;
  const segue::Lock lock(mutex_);
  if (!goal_) return;
  for (const Value& one : all->find("status_list")->as_list()) {
    if (goal_id_of(*one.find("goal_info")) != goal_->id) continue;
    const auto status = one.find("status")->as_int();
    if (status < 1 || status > 6) return;
    // Its end comes with its result, for which it is asked again only where the response may have been lost.
    const bool has_ended = status > 3;
    const auto now = has_ended ? GoalState::Executing : static_cast<GoalState>(status);
    const bool is_back = std::exchange(goal_->is_unseen, false);
    const bool goes_on = is_active(goal_->state) && goal_->state != GoalState::Asked && now > goal_->state;
    if (is_back || goes_on) change(now);
    if (goal_->was_unseen && has_ended && is_active(goal_->state)) put_off_.push_back({goal_->id, false});
    changed_.notify_all();
    return;
  }
}

void RemoteAction::look_for_server() {
  const segue::Lock lock(mutex_);
  if (!goal_ || !is_active(goal_->state) || get_result_->is_served()) return;
  listener_.goal_trouble("the server of action " + action_ + " has left");
  lose_sight();
}

void RemoteAction::lose_sight() {
  goal_->is_unseen = true;
  goal_->was_unseen = true;
  change(GoalState::Lost);
}

RemoteAction::Goal* RemoteAction::current(const GoalId& id) {
  return goal_ && goal_->id == id ? &*goal_ : nullptr;
}

void RemoteAction::change(GoalState state) {
  goal_->state = state;
  listener_.goal_changed(state);
  changed_.notify_all();
}

}  // namespace ros2

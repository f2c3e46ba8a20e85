// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../participant/message_reader.hpp"
#include "../services/requester.hpp"
#include "action_messages.hpp"

#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>
#include <segue/type/value.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

namespace ros2 {

/// Who follows a goal. Called by one thread at a time, which holds the lock of the RemoteAction: must not
/// call it.
class GoalListener {
 public:
  virtual void goal_changed(GoalState state) noexcept = 0;
  /// CDR of the action's feedback; untrusted.
  virtual void feedback_came(std::span<const std::byte> feedback) noexcept = 0;
  /// CDR of the action's result.
  virtual void result_came(std::span<const std::byte> result) noexcept = 0;
  /// Says for the log that something went wrong.
  virtual void goal_trouble(const std::string& what) = 0;

 protected:
  ~GoalListener() = default;
};

/// A client of an action of ROS 2, with one goal at a time: its three services, feedback and status. Any
/// thread.
class RemoteAction {
 public:
  /// `action`: "/navigate"; `interface`: "nav2_msgs/action/NavigateToPose". The listener must outlive it.
  static segue::Result<std::unique_ptr<RemoteAction>> make(std::shared_ptr<Participant> participant,
                                                           segue::ros2::InterfaceLibrary& library,
                                                           const std::string& action,
                                                           const std::string& interface,
                                                           GoalListener& listener);
  ~RemoteAction();
  RemoteAction(const RemoteAction&) = delete;
  RemoteAction& operator=(const RemoteAction&) = delete;

  /// From now on, until stop(), goals are sent.
  void start();
  /// Cancels the goal and waits until it has ended. Fails where the server does not let it end until the
  /// deadline, or refuses to. Afterwards nothing is sent, and the listener is not called.
  segue::Result<void> stop(segue::TimePoint deadline);

  /// Sends a goal and waits for the answer: whether the server has accepted it. The goal takes the place of
  /// an earlier one, which is canceled then. Unavailable: there is no server; InvalidState: there are
  /// several; DeadlineExceeded: it did not answer, and the goal is canceled if it is accepted later.
  segue::Result<bool> send(const segue::type::Value& goal, segue::TimePoint deadline);
  /// Asks the server to cancel the goal; returns when it agrees. InvalidState: there is no goal, or it does
  /// not agree.
  segue::Result<void> cancel(segue::TimePoint deadline);

  [[nodiscard]] std::uint32_t servers() const { return get_result_->servers(); }
  [[nodiscard]] const ActionMessages& messages() const { return messages_; }
  [[nodiscard]] std::vector<segue::ros2::Gid> publishers() const;
  [[nodiscard]] std::vector<segue::ros2::Gid> subscriptions() const;

 private:
  struct Goal {
    GoalId id{};
    GoalState state = GoalState::Asked;
    bool is_unseen = false;    ///< Lost, since its server is not seen
    bool was_unseen = false;   ///< at any time
    bool is_given_up = false;  ///< Lost, since it was not answered: is canceled if it is accepted
  };
  struct PutOff {
    GoalId id{};
    bool cancels = false;  ///< else asks for the result
  };
  RemoteAction(std::shared_ptr<Participant> participant, ActionMessages messages, GoalListener& listener);
  segue::Result<void> open(segue::ros2::InterfaceLibrary& library);
  static segue::type::Value cancel_request(const GoalId& id);

  segue::Result<void> await_server(segue::TimePoint deadline);
  /// Puts it in the place of the earlier one, which is returned where it is active.
  std::optional<GoalId> replace_goal(const GoalId& id);
  segue::Result<bool> await_answer(const GoalId& id, segue::TimePoint deadline);
  /// These send; the server is waited for until the deadline.
  void ask_for_result(const GoalId& id, segue::TimePoint deadline);
  void ask_to_cancel(const GoalId& id, segue::TimePoint deadline);
  /// Sends what threads of Fast DDS, which must not wait, have put off.
  void send_put_off();
  segue::Result<void> cancel(const GoalId& id, segue::TimePoint deadline);
  segue::Result<void> end_goal(segue::TimePoint deadline);

  void take_answer(const GoalId& id, const segue::Result<segue::type::Value>& answer);
  void take_result(const GoalId& id, const segue::Result<segue::type::Value>& answer);
  void take_feedback(std::span<const std::byte> message);
  void take_status(std::span<const std::byte> message);
  void look_for_server();
  void lose_sight() SEGUE_REQUIRES(mutex_);
  /// The goal where it is still that one.
  Goal* current(const GoalId& id) SEGUE_REQUIRES(mutex_);
  void change(GoalState state) SEGUE_REQUIRES(mutex_);

  const std::shared_ptr<Participant> participant_;
  const ActionMessages messages_;
  const std::string action_;  ///< its name
  GoalListener& listener_;
  segue::Mutex mutex_;
  segue::ConditionVariable changed_;
  bool takes_goals_ SEGUE_GUARDED_BY(mutex_) = false;
  std::optional<Goal> goal_ SEGUE_GUARDED_BY(mutex_);
  std::vector<std::byte> feedback_bytes_ SEGUE_GUARDED_BY(mutex_);
  bool sends_put_off_ SEGUE_GUARDED_BY(mutex_) = false;
  std::deque<PutOff> put_off_ SEGUE_GUARDED_BY(mutex_);
  // Destroyed first: their callbacks use what is above.
  std::unique_ptr<Requester> send_goal_;
  std::unique_ptr<Requester> cancel_goal_;
  std::unique_ptr<Requester> get_result_;
  std::unique_ptr<MessageReader> feedback_in_;
  std::unique_ptr<MessageReader> status_in_;
  std::thread sender_;  ///< between start() and stop()
};

}  // namespace ros2

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../participant/types.hpp"
#include "../services/responder.hpp"
#include "../topics/sample_handover.hpp"
#include "action_messages.hpp"
#include "served_goals.hpp"

#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>
#include <segue/task/sample.hpp>
#include <segue/type/value.hpp>

#include <array>
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

/// Who carries out goals, one at a time. Called by the thread of a ServedAction, between its start() and
/// stop().
class GoalWorker {
 public:
  enum class Take : std::uint8_t { Taken, Refused, Corrupt };
  /// CDR of the action's goal, untrusted; it is out if it is taken.
  virtual Take take_goal(std::span<const std::byte> goal) noexcept = 0;
  /// The goal that is out is to be canceled; false: that cannot be told.
  virtual bool take_cancel() noexcept = 0;
  /// Of the goal that is out.
  virtual void goal_changed(GoalState state) noexcept = 0;
  /// Says for the log that something went wrong.
  virtual void goal_trouble(const std::string& what) = 0;

 protected:
  ~GoalWorker() = default;
};

/// How goals are served.
struct ServingRules {
  bool preempts = false;  ///< a new goal cancels the one before; else it is refused
  bool cancelable = true;
  segue::Duration keep_result{};  ///< of a goal that has ended
};

/// A server of an action of ROS 2: its three services, feedback and status, for clients on both middlewares
/// at once. Requests are answered by a thread of its own. Goals and requests that wait are bounded in number.
class ServedAction {
 public:
  /// `action`: "/navigate"; `interface`: "nav2_msgs/action/NavigateToPose". The worker must outlive it.
  static segue::Result<std::unique_ptr<ServedAction>> make(std::shared_ptr<Participant> participant,
                                                           segue::ros2::InterfaceLibrary& library,
                                                           const std::string& action,
                                                           const std::string& interface,
                                                           const ServingRules& rules, GoalWorker& worker);
  ~ServedAction();
  ServedAction(const ServedAction&) = delete;
  ServedAction& operator=(const ServedAction&) = delete;

  /// From now on, until stop(), goals are accepted. Before and after, requests are answered, too.
  void start();
  /// Ends all goals as aborted, and waits until clients that have asked for their results have them, until
  /// the deadline at most. Afterwards the worker is not called.
  void stop(segue::TimePoint deadline);

  /// These are for updates: they do not wait for the thread.
  /// Whether the worker has a goal whose client has not been told yet: samples for it have to wait. The
  /// worker is told of a change afterwards.
  [[nodiscard]] bool is_announcing() const { return is_announcing_; }
  /// Sends feedback of the goal that is out.
  void tell(const segue::task::SampleSlot& feedback);
  /// Ends the goal that is out as Succeeded, Canceled or Aborted; false: none is. The worker is told of the
  /// change afterwards.
  bool end(GoalState how, segue::task::SampleRef result);

  /// Counts samples that were for no goal.
  void count_unasked(std::size_t samples);
  [[nodiscard]] ActionServerStatistics statistics();
  [[nodiscard]] const ActionMessages& messages() const { return messages_; }
  [[nodiscard]] std::vector<segue::ros2::Gid> publishers() const;
  [[nodiscard]] std::vector<segue::ros2::Gid> subscriptions() const;

 private:
  enum class Service : std::uint8_t { SendGoal, CancelGoal, GetResult };
  struct Request {
    Service service{};
    Caller caller;
    std::vector<std::byte> message;
  };
  /// Of a goal that has not ended.
  struct ResultRequest {
    GoalId goal{};
    Caller caller;
    segue::TimePoint came{};
  };
  struct Response {
    Service service{};
    Caller caller;
    std::vector<std::byte> message;
    segue::TimePoint give_up{};
  };

  ServedAction(std::shared_ptr<Participant> participant, ActionMessages messages, const ServingRules& rules,
               GoalWorker& worker);
  segue::Result<void> open(segue::ros2::InterfaceLibrary& library);
  segue::Result<Participant::Owned<dds::DataWriter>> make_writer(const std::string& topic,
                                                                 const segue::ros2::MessageCodec& message,
                                                                 const segue::ros2::Quality& quality);
  Responder& responder(Service service) const { return *responders_.at(static_cast<std::size_t>(service)); }

  [[nodiscard]] std::optional<GoalId> current();
  /// In a thread of Fast DDS.
  void receive(Service service, const Caller& caller, std::vector<std::byte> message);

  // All that follow are called by the thread of its own.
  void serve();
  [[nodiscard]] segue::TimePoint next_look() const;
  void take_ends();
  void answer(const Request& request, bool accepts);
  void answer_goal(const Request& request, bool accepts);
  void answer_cancel(const Request& request);
  void answer_result(const Request& request);
  [[nodiscard]] GoalWorker::Take look_at(std::span<const std::byte> goal) const;
  /// Cancels the goal that is out, and the one that waits, for a new one.
  void make_way();
  /// Gives the waiting goal to the worker, if none is out.
  void begin_waiting();
  void set_out(ServedGoal& goal);
  /// False: the server, or its worker, refuses.
  bool cancel(ServedGoal& goal);
  void end(ServedGoal& goal, GoalState how, const segue::type::Value& result);
  void end_all();
  [[nodiscard]] segue::Result<segue::type::Value> value_of(const segue::task::SampleSlot& result) const;
  void respond(const Request& request, const segue::type::Value& response);
  void respond(Service service, const Caller& caller, std::vector<std::byte> message);
  void send_responses();
  /// Where too many wait, those of clients that have left are forgotten.
  bool has_room_for_result_request();
  void publish_status();
  void set_current(const std::optional<GoalId>& id);
  void count(std::uint64_t ActionServerStatistics::*counter);

  const std::shared_ptr<Participant> participant_;
  const ActionMessages messages_;
  const ServingRules rules_;
  GoalWorker& worker_;
  ThreadWaker waker_;
  std::atomic<bool> is_announcing_{false};
  std::array<SampleHandover, 3> ends_;  ///< by Succeeded, Canceled and Aborted
  segue::Mutex current_mutex_;          ///< for a copy at a time, since updates wait for it
  std::optional<GoalId> current_ SEGUE_GUARDED_BY(current_mutex_);  ///< the goal that is out
  segue::Mutex mutex_;
  segue::ConditionVariable changed_;
  bool accepts_ SEGUE_GUARDED_BY(mutex_) = false;
  bool is_quiet_ SEGUE_GUARDED_BY(mutex_) = false;  ///< since accepts_ is false: nothing is left to be sent
  bool leaves_ SEGUE_GUARDED_BY(mutex_) = false;
  std::deque<Request> requests_ SEGUE_GUARDED_BY(mutex_);
  ActionServerStatistics counts_ SEGUE_GUARDED_BY(mutex_);
  // Used by the thread of its own.
  ServedGoals goals_;
  std::vector<ResultRequest> result_requests_;
  std::vector<Response> responses_;  ///< to clients that do not get them yet
  Participant::Owned<dds::DataWriter> feedback_out_;
  Participant::Owned<dds::DataWriter> status_out_;
  std::array<std::unique_ptr<Responder>, 3> responders_;  ///< destroyed first: their callbacks use all others
  std::thread thread_;
};

}  // namespace ros2

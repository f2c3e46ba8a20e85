// SPDX-License-Identifier: Apache-2.0
#include "../participant/node_task.hpp"
#include "../participant/types.hpp"
#include "../topics/cdr_output.hpp"
#include "remote_action.hpp"
#include "told_state.hpp"

#include <segue/base/log.hpp>
#include <segue/task/operation.hpp>
#include <segue/task/sub_state.hpp>
#include <segue/task/typed_port.hpp>

#include <array>
#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <thread>

namespace ros2 {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

static segue::Activity in_shared_actions() {
  segue::Activity activity = segue::fd_driven();
  activity.thread = "ros2_actions";
  return activity;
}

/// A task for one action of ROS 2: its operation `send_goal` sends a goal, its states and ports tell how that
/// goes on, and whatever stops it cancels the goal. Results and feedback are written in threads of Fast DDS;
/// states are entered by updates, for which a timer is set to now.
class ActionClient final : public NodeTask, private GoalListener {
 public:
  ActionClient()
      : NodeTask({.doc = "Has goals carried out by an action of ROS 2", .activity = in_shared_actions()}),
        send_goal_(
            *this,
            {"send_goal",
             {{"goal", nullptr, ""}},
             "/bool",
             RunsIn::CallerThread,
             "sends a goal, {order: 5}, and returns whether the server accepts it; fields that are left "
             "out have their defaults"},
            [this](const std::vector<segue::type::Value>& arguments) { return send(arguments.front()); }) {
    dynamic_ports(Direction::Output, "feedback|result", "its type is of the property type");
  }

 protected:
  segue::Result<void> on_configure() override {
    if (*timeout_ <= std::chrono::nanoseconds(0))
      return segue::fail(segue::ErrorCode::InvalidArgument, "timeout must be positive");
    if (auto joined = join(); !joined) return joined;
    auto interfaces = library();
    auto made = RemoteAction::make(shared_participant(), interfaces, *action_text_, *type_, *this);
    if (auto opened = goal_state_.open(); made && !opened) made = opened.error();
    if (!made) {
      leave();
      return made.error();
    }
    feedback_.emplace(*this, "feedback", (*made)->messages().feedback, "of the goal, as it comes");
    result_.emplace(*this, "result", (*made)->messages().result, "of each goal that has ended");
    {
      const segue::Lock lock(counts_mutex_);
      counts_ = {};
    }
    const segue::Lock lock(mutex_);
    action_ = std::move(*made);
    call_timeout_ = *timeout_;
    announce(action_->publishers(), action_->subscriptions());
    return {};
  }

  segue::Result<void> on_start() override {
    goal_state_.begin();
    if (auto driven = trigger_fd(goal_state_.descriptor()); !driven) return driven;
    runs_ = true;
    action()->start();
    return {};
  }

  void on_update() override {
    goal_state_.update([this](GoalState state) { show(state); });
  }

  void on_stop() override {
    runs_ = false;
    if (auto ended = action()->stop(segue::Deadline(*timeout_)); !ended)
      exception("the goal may go on: " + segue::to_string(ended.error()));
  }

  void on_cleanup() override {
    withdraw();
    std::shared_ptr<RemoteAction> ended;
    {
      const segue::Lock lock(mutex_);
      ended = std::move(action_);
    }
    // A call in progress may still have it, but its end is near: stop has come before.
    while (ended.use_count() > 1)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ended.reset();
    feedback_.reset();
    result_.reset();
    goal_state_.close();
    leave();
  }

 private:
  std::shared_ptr<RemoteAction> action() {
    const segue::Lock lock(mutex_);
    return action_;
  }

  void show(GoalState state) {
    constexpr std::array<std::int8_t, 10> kStatus = {0, 1, 2, 3, 4, 5, 6, 0, 0, 0};
    const std::array<const State*, 10> states = {nullptr,     &accepted_, &executing_, &canceling_,
                                                 &succeeded_, &canceled_, &aborted_,   &refused_,
                                                 &lost_,      &asked_};
    const auto number = static_cast<std::size_t>(state);
    if (states.at(number) == nullptr) return;
    status_.write(kStatus.at(number));
    states.at(number)->enter();
  }

  /// In the thread of the caller. It returns when the task is in a state of this goal, lest one of an earlier
  /// goal is taken for it.
  segue::Result<segue::type::Value> send(const segue::type::Value& goal) {
    segue::Lock lock(mutex_);
    const auto action = action_;
    const segue::Deadline deadline(call_timeout_);
    lock.unlock();
    if (action == nullptr)
      return segue::fail(segue::ErrorCode::InvalidState, "no goal is sent: the task is not configured");
    const auto accepted = action->send(goal, deadline);
    count(&ActionStatistics::goals);
    const std::uint32_t told = goal_state_.told();
    while (runs_ && !goal_state_.has_entered(told) && segue::monotonic_now() < segue::TimePoint(deadline))
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (!accepted) return accepted.error();
    return segue::type::Value(*accepted);
  }

  segue::Result<void> cancel() {
    segue::Lock lock(mutex_);
    const auto action = action_;
    const segue::Deadline deadline(call_timeout_);
    lock.unlock();
    if (action == nullptr)
      return segue::fail(segue::ErrorCode::InvalidState, "no goal is canceled: the task is not configured");
    return action->cancel(deadline);
  }

  void goal_changed(GoalState state) noexcept override { goal_state_.tell(state); }
  void feedback_came(std::span<const std::byte> feedback) noexcept override {
    const auto outcome = feedback_->publish(feedback);
    count(outcome == CdrOutput::Outcome::Corrupt ? &ActionStatistics::corrupt : &ActionStatistics::feedback);
  }
  void result_came(std::span<const std::byte> result) noexcept override {
    if (result_->publish(result) == CdrOutput::Outcome::Corrupt) count(&ActionStatistics::corrupt);
  }
  void goal_trouble(const std::string& what) override { segue::log(segue::LogLevel::Warning, id(), what); }

  void count(std::uint64_t ActionStatistics::*counter) {
    const segue::Lock lock(counts_mutex_);
    ++(counts_.*counter);
  }
  ActionStatistics statistics() {
    segue::Lock lock(counts_mutex_);
    ActionStatistics now = counts_;
    lock.unlock();
    if (const auto action = this->action(); action != nullptr) now.servers = action->servers();
    return now;
  }

  Property<std::string> action_text_{*this, "action", {}, {.doc = "name of the action: /navigate_to_pose"}};
  Property<std::string> type_{*this, "type", {}, {.doc = "its interface: nav2_msgs/action/NavigateToPose"}};
  Property<std::chrono::nanoseconds> timeout_{
      *this,
      "timeout",
      std::chrono::seconds(5),
      {.doc =
           "how long a server is waited for, and for its answers; how long a stop waits for the goal's end"}};
  OutputPort<std::int8_t> status_{
      *this,
      "status",
      {.doc = "of the goal: 1 accepted, 2 executing, 3 canceling, 4 succeeded, 5 canceled, "
              "6 aborted; 0: refused, lost or not answered yet"}};
  State asked_{*this, "asked"};
  State accepted_{*this, "accepted"};
  State executing_{*this, "executing"};
  State canceling_{*this, "canceling"};
  State succeeded_{*this, "succeeded"};
  State canceled_{*this, "canceled"};
  State aborted_{*this, "aborted"};
  State refused_{*this, "refused"};
  State lost_{*this, "lost"};
  DynamicOperation send_goal_;
  Operation<segue::Result<void>()> cancel_{*this,
                                           "cancel",
                                           {},
                                           [this] { return cancel(); },
                                           RunsIn::CallerThread,
                                           "asks the server to cancel the goal; returns when it agrees"};
  Operation<ActionStatistics()> statistics_{
      *this, "statistics", {}, [this] { return statistics(); }, RunsIn::CallerThread, "what has come so far"};
  ToldState goal_state_;
  std::atomic<bool> runs_{false};
  segue::Mutex counts_mutex_;
  ActionStatistics counts_ SEGUE_GUARDED_BY(counts_mutex_);
  // Changed only while there is no RemoteAction, whose callbacks use them.
  std::optional<CdrOutput> feedback_;
  std::optional<CdrOutput> result_;
  segue::Mutex mutex_;
  std::shared_ptr<RemoteAction> action_ SEGUE_GUARDED_BY(mutex_);
  std::chrono::nanoseconds call_timeout_ SEGUE_GUARDED_BY(mutex_){};
};

}  // namespace ros2

SEGUE_COMPONENT(ros2::ActionClient)

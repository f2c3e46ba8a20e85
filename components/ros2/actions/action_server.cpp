// SPDX-License-Identifier: Apache-2.0
#include "../participant/node_task.hpp"
#include "../participant/types.hpp"
#include "../topics/cdr_output.hpp"
#include "served_action.hpp"
#include "told_state.hpp"

#include <segue/base/clock.hpp>
#include <segue/base/log.hpp>
#include <segue/base/text.hpp>
#include <segue/task/any_port.hpp>
#include <segue/task/operation.hpp>
#include <segue/task/sub_state.hpp>
#include <segue/task/typed_port.hpp>

#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <utility>

namespace ros2 {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

static segue::Activity in_shared_action_servers() {
  segue::Activity activity;
  activity.thread = "ros2_action_servers";
  return activity;
}

/// Serves an action of ROS 2: goals go out at `goal`, one at a time, and samples at the inputs are its
/// feedback and its result. Requests are answered by the thread of the ServedAction; an update hands it what
/// ends the goal, and enters the states that it tells.
class ActionServer final : public NodeTask, private GoalWorker {
 public:
  ActionServer()
      : NodeTask({.doc = "Serves an action of ROS 2",
                  .activity = in_shared_action_servers(),
                  .trigger_on = {"feedback", "succeeded", "canceled", "aborted"}}) {
    dynamic_ports(Direction::Output, "goal", "its type is of the property type");
    dynamic_ports(Direction::Input, "feedback|succeeded|canceled|aborted",
                  "its type is of the property type");
  }

 protected:
  segue::Result<void> on_configure() override {
    auto rules = wanted_rules();
    if (!rules) return rules.error();
    if (auto joined = join(); !joined) return joined;
    auto interfaces = library();
    auto made = ServedAction::make(shared_participant(), interfaces, *action_text_, *type_, *rules, *this);
    if (auto opened = goal_state_.open(); made && !opened) made = opened.error();
    if (!made) {
      leave();
      return made.error();
    }
    action_ = std::move(*made);
    make_ports();
    announce(action_->publishers(), action_->subscriptions());
    const segue::Lock lock(shown_mutex_);
    shown_ = action_.get();
    return {};
  }

  segue::Result<void> on_start() override {
    goal_state_.begin();
    has_ended_ = false;
    if (auto driven = trigger_fd(goal_state_.descriptor()); !driven) return driven;
    // They were for goals that have ended.
    std::size_t late = feedback_->drain();
    for (End& end : ends_)
      late += end.port->drain();
    action_->count_unasked(late);
    action_->start();
    return {};
  }

  void on_update() override {
    goal_state_.update([this](GoalState state) { follow(state); });
    if (action_->is_announcing()) return;
    // Feedback from before an end is still of the goal that ends.
    for (End& end : ends_)
      end.sample = end.port->take();
    constexpr int kMost = 64;
    for (int i = 0; i < kMost; ++i) {
      const SampleRef sample = feedback_->take();
      if (!sample) break;
      action_->tell(*sample.get());
    }
    for (End& end : ends_) {
      if (!end.sample || !action_->end(end.how, std::exchange(end.sample, SampleRef()))) continue;
      show(end.how);
      has_ended_ = true;
    }
  }

  void on_stop() override { action_->stop(segue::monotonic_now() + kStops); }

  void on_cleanup() override {
    withdraw();
    {
      const segue::Lock lock(shown_mutex_);
      shown_ = nullptr;
    }
    goal_.reset();
    feedback_.reset();
    for (End& end : ends_)
      end.port.reset();
    action_.reset();
    goal_state_.close();
    leave();
  }

 private:
  struct End {
    GoalState how;
    const char* name;
    const char* doc;
    std::optional<AnyInput> port{};
    SampleRef sample{};
  };

  /// Longer than clients are waited for that do not get their results yet.
  static constexpr std::chrono::seconds kStops{3};

  segue::Result<ServingRules> wanted_rules() const {
    using segue::ErrorCode;
    using segue::fail;
    if (*when_busy_ != "reject" && *when_busy_ != "preempt") {
      return fail(ErrorCode::InvalidArgument,
                  "when_busy " + segue::quote(*when_busy_) + " is not known: expected reject or preempt");
    }
    const ServingRules rules{*when_busy_ == "preempt", *cancelable_, *keep_result_};
    if (rules.keep_result < segue::Duration(0))
      return fail(ErrorCode::InvalidArgument, "keep_result must not be negative");
    if (rules.preempts && !rules.cancelable) {
      return fail(ErrorCode::InvalidArgument,
                  "when_busy: preempt cancels goals, so they must be cancelable; set cancelable to true, or "
                  "when_busy to reject");
    }
    return rules;
  }

  void make_ports() {
    const ActionMessages& messages = action_->messages();
    goal_.emplace(*this, "goal", messages.goal, "goals, one at a time");
    feedback_.emplace(*this, "feedback", &messages.feedback.info(), std::string(),
                      PortOptions{.dynamic = true, .doc = "of the goal", .flat = true});
    for (End& end : ends_) {
      end.port.emplace(*this, end.name, &messages.result.info(), std::string(),
                       PortOptions{.dynamic = true, .doc = end.doc, .flat = true});
    }
  }

  /// Whoever has written the end of a goal finds that state with the update that has read it, not that of
  /// before, which he might take for that of the next goal.
  void follow(GoalState state) {
    if (has_ended_ && state == GoalState::Canceling) return;
    has_ended_ = false;
    show(state);
  }

  void show(GoalState state) {
    const std::array<const State*, 7> states = {nullptr,     nullptr,    &executing_, &canceling_,
                                                &succeeded_, &canceled_, &aborted_};
    const auto number = static_cast<std::size_t>(state);
    if (number < states.size() && states.at(number) != nullptr) states.at(number)->enter();
  }

  Take take_goal(std::span<const std::byte> goal) noexcept override {
    if (goal_->dormant()) return Take::Refused;
    cancel_.write(false);
    const auto outcome = goal_->publish(goal);
    if (outcome == CdrOutput::Outcome::Corrupt) return Take::Corrupt;
    return outcome == CdrOutput::Outcome::Published ? Take::Taken : Take::Refused;
  }
  bool take_cancel() noexcept override { return cancel_.write(true) != WriteResult::Refused; }
  void goal_changed(GoalState state) noexcept override { goal_state_.tell(state); }
  void goal_trouble(const std::string& what) override { segue::log(segue::LogLevel::Warning, id(), what); }

  ActionServerStatistics statistics() {
    const segue::Lock lock(shown_mutex_);
    return shown_ == nullptr ? ActionServerStatistics() : shown_->statistics();
  }

  Property<std::string> action_text_{*this, "action", {}, {.doc = "name of the action: /navigate_to_pose"}};
  Property<std::string> type_{*this, "type", {}, {.doc = "its interface: nav2_msgs/action/NavigateToPose"}};
  Property<std::string> when_busy_{
      *this,
      "when_busy",
      "reject",
      {.doc =
           "of a goal that comes while another one is under way: reject, or preempt, which cancels that one "
           "and begins the new one when it has ended"}};
  Property<bool> cancelable_{
      *this, "cancelable", true, {.doc = "false: requests to cancel a goal are refused"}};
  Property<std::chrono::nanoseconds> keep_result_{
      *this,
      "keep_result",
      std::chrono::seconds(10),
      {.doc = "how long clients can ask for the result of a goal that has ended"}};
  OutputPort<bool> cancel_{
      *this, "cancel", {.doc = "true: the goal is to be canceled, or the task stops; false: with each goal"}};
  State executing_{*this, "executing"};
  State canceling_{*this, "canceling"};
  State succeeded_{*this, "succeeded"};
  State canceled_{*this, "canceled"};
  State aborted_{*this, "aborted"};
  Operation<ActionServerStatistics()> statistics_{*this,
                                                  "statistics",
                                                  {},
                                                  [this] { return statistics(); },
                                                  RunsIn::CallerThread,
                                                  "what was served so far"};
  ToldState goal_state_;
  bool has_ended_ = false;  ///< as this task was told; the ServedAction may not know yet
  // Changed only while no thread of a ServedAction uses them.
  std::optional<CdrOutput> goal_;
  std::optional<AnyInput> feedback_;
  std::array<End, 3> ends_ = {
      End{GoalState::Succeeded, "succeeded", "the result of the goal, which is reached"},
      End{GoalState::Canceled, "canceled", "the result of the goal, which has ended since it was canceled"},
      End{GoalState::Aborted, "aborted", "the result of the goal, which has failed"}};
  std::unique_ptr<ServedAction> action_;
  segue::Mutex shown_mutex_;
  ServedAction* shown_ SEGUE_GUARDED_BY(shown_mutex_) = nullptr;  ///< for operations
};

}  // namespace ros2

SEGUE_COMPONENT(ros2::ActionServer)

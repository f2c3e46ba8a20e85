// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../services/requester.hpp"

#include <segue/base/result.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace ros2 {

/// The states of a managed node by their numbers in lifecycle_msgs/msg/State.
enum class NodeState : std::uint8_t {
  Unknown = 0,
  Unconfigured = 1,
  Inactive = 2,
  Active = 3,
  Finalized = 4,
  Configuring = 10,
  CleaningUp = 11,
  ShuttingDown = 12,
  Activating = 13,
  Deactivating = 14,
  ErrorProcessing = 15
};

/// "unconfigured", "error processing"
std::string_view to_string(NodeState state);

/// Drives a managed node of ROS 2 by its life-cycle services. Waits for its services; any thread.
class LifecycleClient {
 public:
  /// `node`: "/robot/talker". Fails as Requester::make() does.
  static segue::Result<std::unique_ptr<LifecycleClient>> make(const std::shared_ptr<Participant>& participant,
                                                              const std::string& node);

  /// The state that the node says it has.
  segue::Result<NodeState> state(segue::TimePoint deadline);
  /// Asks for it without waiting: `told` is called in a thread of Fast DDS if the node answers before it is
  /// asked again or forget() is called. Not during drive().
  void ask(std::function<void(NodeState)> told);
  void forget();
  /// Takes the node from whatever state it is in to Unconfigured, Inactive or Active, by as many transitions
  /// as that needs. The true state is read before each of them and at the end, so a response that is lost,
  /// late or wrong does no harm. InvalidState: the node refuses a transition or fails in it, says that it did
  /// one that it did not, is finalized, or is there twice; DeadlineExceeded: it is not there yet;
  /// Unavailable: it is not there at all.
  segue::Result<void> drive(NodeState goal, segue::TimePoint deadline);
  /// Calls in progress and later ones end at once. Any thread.
  void cancel();

  /// Whether two nodes of that name answer.
  [[nodiscard]] bool is_there_twice() const {
    return get_state_->has_rivals() || change_state_->has_rivals();
  }
  /// The error where two nodes answer, for which their answers are waited for some time, or else `error`:
  /// answers of two nodes contradict each other.
  segue::Error there_twice_or(segue::Error error);
  /// Whether the services of its life cycle are seen. That they are not is no proof that the node has ended.
  [[nodiscard]] bool is_seen() const { return get_state_->servers() > 0 && change_state_->servers() > 0; }
  [[nodiscard]] std::vector<const Requester*> requesters() const;

 private:
  LifecycleClient() = default;
  [[nodiscard]] segue::Error there_twice() const;
  [[nodiscard]] segue::Result<NodeState> state_in(const segue::type::Value& response) const;
  /// Not that of a transition, but at the deadline.
  segue::Result<NodeState> settled_state(segue::TimePoint deadline);
  /// One transition on the way; whether it was done is read from the state.
  segue::Result<void> step(NodeState from, NodeState goal, segue::TimePoint deadline);

  std::string node_;
  std::unique_ptr<Requester> change_state_;
  std::unique_ptr<Requester> get_state_;
};

}  // namespace ros2

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "count_messages.hpp"
#include "peer.hpp"

#include <segue/ros2/message_codec.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

namespace ros2::testing {

/// A server of the action "/count" (test_msgs/action/Count: count to `target`), which does what a test tells
/// it to. What it waits for comes soon, or the test fails.
class ActionPeer {
 public:
  /// A request with the bytes of the goal's identifier.
  struct Asked {
    Request request;
    segue::type::Value value;
    segue::type::Value id;
  };

  ActionPeer(const std::function<std::unique_ptr<Peer>()>& make_peer, const std::filesystem::path& folder);

  Asked next_goal();
  Asked next_cancel();
  Asked next_result_request();
  /// How many have come.
  std::size_t cancels() { return cancel_->requests().size(); }
  void answer_goal(const Asked& goal, bool accepts);
  /// The numbers of action_msgs/srv/CancelGoal.
  void answer_cancel(const Asked& cancel, int code);
  /// The numbers of action_msgs/msg/GoalStatus.
  void answer_result(const Asked& result, int status, int reached);
  void tell_feedback(const segue::type::Value& id, int now);
  void tell_status(const segue::type::Value& id, int status);
  /// These send bytes that are no message of their type.
  void answer_goal_malformed(const Asked& goal);
  void answer_result_malformed(const Asked& result);
  void tell_malformed_feedback(const segue::type::Value& id);
  void serve();
  void leave();

 private:
  static Asked next(Peer& peer, const segue::ros2::MessageCodec& codec);

  const ActionCodecs codecs_;
  std::unique_ptr<Peer> send_goal_;  ///< and feedback
  std::unique_ptr<Peer> cancel_;     ///< and status
  std::unique_ptr<Peer> get_result_;
};

}  // namespace ros2::testing

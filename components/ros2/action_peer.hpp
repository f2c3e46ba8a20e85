// SPDX-License-Identifier: Apache-2.0
#pragma once

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

  /// Writes the definition of the action to that folder, which is one of the property `interfaces`.
  static void define(const std::filesystem::path& folder);
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
  segue::ros2::MessageCodec codec(const std::string& message);
  static Asked next(Peer& peer, const segue::ros2::MessageCodec& codec);

  segue::ros2::InterfaceLibrary library_;
  const segue::ros2::MessageCodec goal_request_ = codec("test_msgs/action/Count_SendGoal_Request");
  const segue::ros2::MessageCodec goal_response_ = codec("test_msgs/action/Count_SendGoal_Response");
  const segue::ros2::MessageCodec cancel_request_ = codec("action_msgs/srv/CancelGoal_Request");
  const segue::ros2::MessageCodec cancel_response_ = codec("action_msgs/srv/CancelGoal_Response");
  const segue::ros2::MessageCodec result_request_ = codec("test_msgs/action/Count_GetResult_Request");
  const segue::ros2::MessageCodec result_response_ = codec("test_msgs/action/Count_GetResult_Response");
  const segue::ros2::MessageCodec feedback_message_ = codec("test_msgs/action/Count_FeedbackMessage");
  const segue::ros2::MessageCodec status_message_ = codec("action_msgs/msg/GoalStatusArray");
  std::unique_ptr<Peer> send_goal_;  ///< and feedback
  std::unique_ptr<Peer> cancel_;     ///< and status
  std::unique_ptr<Peer> get_result_;
};

}  // namespace ros2::testing

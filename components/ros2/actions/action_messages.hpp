// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/ros2/message_codec.hpp>
#include <segue/ros2/participant_entities.hpp>
#include <segue/ros2/quality.hpp>
#include <segue/type/value.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// Shared by clients and servers of actions of ROS 2 ("Actions", design.ros2.org).
namespace ros2 {

/// How far a goal is. Up to Aborted the numbers are those of action_msgs/msg/GoalStatus.
enum class GoalState : std::uint8_t {
  None = 0,  ///< there is no goal
  Accepted = 1,
  Executing = 2,
  Canceling = 3,
  Succeeded = 4,
  Canceled = 5,
  Aborted = 6,
  Refused,  ///< the server did not accept it
  Lost,     ///< how it goes on or ended is not known
  Asked     ///< the server has not answered yet
};

/// Whether the server still has something to do for it.
inline bool is_active(GoalState state) {
  return state == GoalState::Asked || (state >= GoalState::Accepted && state <= GoalState::Canceling);
}

/// The answer to a request to cancel: the numbers of action_msgs/srv/CancelGoal.
enum class CancelCode : std::uint8_t {
  Agrees = 0,
  Refuses = 1,
  UnknownGoal = 2,
  HasEnded = 3  ///< or is being canceled already
};

using GoalId = segue::ros2::Gid;

/// The messages of an action, and the names of its services and topics.
struct ActionMessages {
  std::string action;     ///< "/navigate"
  std::string interface;  ///< "nav2_msgs/action/NavigateToPose"
  segue::ros2::MessageCodec goal;
  segue::ros2::MessageCodec feedback;
  segue::ros2::MessageCodec result;
  segue::ros2::MessageCodec feedback_message;  ///< feedback with the identifier of its goal
  segue::ros2::MessageCodec status;

  /// InvalidArgument where it is not a name of an action or not one's interface.
  static segue::Result<ActionMessages> of(segue::ros2::InterfaceLibrary& library, std::string action,
                                          std::string interface);

  struct Service {
    std::string name;
    std::string interface;
  };
  [[nodiscard]] Service send_goal() const { return {name_of("send_goal"), interface + "_SendGoal"}; }
  [[nodiscard]] Service cancel_goal() const { return {name_of("cancel_goal"), "action_msgs/srv/CancelGoal"}; }
  [[nodiscard]] Service get_result() const { return {name_of("get_result"), interface + "_GetResult"}; }
  [[nodiscard]] std::string feedback_topic() const { return name_of("feedback"); }
  [[nodiscard]] std::string status_topic() const { return name_of("status"); }
  /// Those of feedback are the default.
  static segue::ros2::Quality status_quality();

 private:
  [[nodiscard]] std::string name_of(const char* part) const { return action + "/_action/" + part; }
};

/// {goal_id: {uuid: [...]}}, which also is a request for a result.
segue::type::Value goal_id_value(const GoalId& id);
/// The inverse, of a decoded message.
GoalId goal_id_of(const segue::type::Value& message);

/// In a message that has no more than the identifier of a goal (unique_identifier_msgs/msg/UUID) before a
/// part of its own, as requests for goals and feedback have: where the identifier ends.
inline constexpr std::size_t kEndOfGoalId = 4 + 16;
/// CDR of the goal or feedback, from CDR of such a message, in `part`; nothing, and `part` empty, where the
/// bytes, which are untrusted, are too few.
std::optional<GoalId> split_goal_id(std::span<const std::byte> message, std::vector<std::byte>& part);
/// The reverse in place: `bytes` has CDR of the part from its sixteenth byte on, and room for the identifier
/// before.
void put_goal_id(const GoalId& id, std::span<std::byte> bytes);

}  // namespace ros2

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "peer.hpp"

#include <segue/ros2/message_codec.hpp>
#include <segue/type/describe.hpp>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

/// The structs of a user who has the messages of test_msgs/action/Count as C++ types.
namespace test_msgs {
struct Count_Goal {
  std::int32_t target = 0;
};
struct Count_Result {
  std::int64_t reached = 0;
  std::string words;
};
struct Count_Feedback {
  std::int32_t now = 0;
  std::string words;
};
}  // namespace test_msgs
SEGUE_TYPE(test_msgs::Count_Goal, target)
SEGUE_TYPE(test_msgs::Count_Result, reached, words)
SEGUE_TYPE(test_msgs::Count_Feedback, now, words)

/// The action "/count" of peers: count to `target`.
namespace ros2::testing {

inline constexpr const char* kCount = "test_msgs/action/Count";
/// The longest of `words`.
inline constexpr std::size_t kMostWords = 20;

/// Writes its definition to that folder, which is one of the property `interfaces`.
inline void define_count(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder / "test_msgs/action");
  std::ofstream(folder / "test_msgs/action/Count.action")
      << "int32 target\n---\nint64 reached\nstring<=20 words\n---\nint32 now\nstring<=20 words\n";
}

/// The messages of an action such as kCount.
class ActionCodecs {
 public:
  ActionCodecs(const std::filesystem::path& folder, const std::string& interface)
      : library_({folder}), interface_(interface) {}

 private:
  segue::ros2::MessageCodec of(const std::string& message) {
    return segue::ros2::MessageCodec::of(library_, message).value();
  }
  segue::ros2::InterfaceLibrary library_;
  std::string interface_;

 public:
  const segue::ros2::MessageCodec goal_request = of(interface_ + "_SendGoal_Request");
  const segue::ros2::MessageCodec goal_response = of(interface_ + "_SendGoal_Response");
  const segue::ros2::MessageCodec cancel_request = of("action_msgs/srv/CancelGoal_Request");
  const segue::ros2::MessageCodec cancel_response = of("action_msgs/srv/CancelGoal_Response");
  const segue::ros2::MessageCodec result_request = of(interface_ + "_GetResult_Request");
  const segue::ros2::MessageCodec result_response = of(interface_ + "_GetResult_Response");
  const segue::ros2::MessageCodec feedback = of(interface_ + "_FeedbackMessage");
  const segue::ros2::MessageCodec status = of("action_msgs/msg/GoalStatusArray");
};

/// The topics of "/count".
inline TopicOf count_feedback(const std::string& interface) {
  return {"/count/_action/feedback", interface + "_FeedbackMessage", "", {}};
}
inline TopicOf count_status() {
  segue::ros2::Quality latched;
  latched.durability = segue::ros2::Durability::TransientLocal;
  latched.depth = 1;
  return {"/count/_action/status", "action_msgs/msg/GoalStatusArray", "", latched};
}

/// The three peers are a server of "/count"; the first has feedback, too, and the second the status.
inline void serve_count(Peer& goals, Peer& cancels, Peer& results, const std::string& interface) {
  goals.serve("/count/_action/send_goal", interface + "_SendGoal");
  cancels.serve("/count/_action/cancel_goal", "action_msgs/srv/CancelGoal");
  results.serve("/count/_action/get_result", interface + "_GetResult");
  goals.advertise(count_feedback(interface));
  cancels.advertise(count_status());
}

/// They are a client of it.
inline void use_count(Peer& goals, Peer& cancels, Peer& results) {
  goals.use("/count/_action/send_goal", std::string(kCount) + "_SendGoal");
  cancels.use("/count/_action/cancel_goal", "action_msgs/srv/CancelGoal");
  results.use("/count/_action/get_result", std::string(kCount) + "_GetResult");
  goals.subscribe(count_feedback(kCount));
  cancels.subscribe(count_status());
}

/// As it is in messages: {uuid: [...]}, each of whose bytes is `byte`.
inline segue::type::Value goal_id_of_byte(int byte) {
  return segue::type::Value::map(
      {{"uuid", segue::type::Value(segue::type::Value::List(16, segue::type::Value(byte)))}});
}

}  // namespace ros2::testing

// SPDX-License-Identifier: Apache-2.0
#include "action_messages.hpp"

#include <segue/ros2/dds_names.hpp>
#include <segue/ros2/interface_definition.hpp>

#include <algorithm>
#include <utility>

namespace ros2 {
namespace {

using segue::type::Value;

/// CDR begins with so many bytes, which say how it is encoded.
constexpr std::size_t kHeaderBytes = 4;
constexpr std::size_t kIdBytes = kEndOfGoalId - kHeaderBytes;

}  // namespace

segue::Result<ActionMessages> ActionMessages::of(segue::ros2::InterfaceLibrary& library, std::string action,
                                                 std::string interface) {
  using segue::ros2::MessageCodec;
  if (auto valid = segue::ros2::dds_topic_name(action); !valid) return valid.error();
  if (const auto name = segue::ros2::parse_interface_name(interface); name && name->kind != "action")
    return segue::fail(segue::ErrorCode::InvalidArgument, interface + " is not an action");
  std::vector<MessageCodec> codecs;
  for (const std::string& name :
       {interface + "_Goal", interface + "_Feedback", interface + "_Result", interface + "_FeedbackMessage",
        std::string("action_msgs/msg/GoalStatusArray")}) {
    auto codec = MessageCodec::of(library, name);
    if (!codec) return codec.error();
    codecs.push_back(std::move(*codec));
  }
  return ActionMessages{std::move(action), std::move(interface), codecs[0], codecs[1], codecs[2], codecs[3],
                        codecs[4]};
}

segue::ros2::Quality ActionMessages::status_quality() {
  segue::ros2::Quality quality;
  quality.durability = segue::ros2::Durability::TransientLocal;
  quality.depth = 1;
  return quality;
}

Value goal_id_value(const GoalId& id) {
  Value::List bytes(id.begin(), id.end());
  return Value::map({{"goal_id", Value::map({{"uuid", Value(std::move(bytes))}})}});
}

GoalId goal_id_of(const Value& message) {
  GoalId id{};
  const auto& bytes = message.find("goal_id")->find("uuid")->as_list();
  std::ranges::transform(bytes, id.begin(),
                         [](const Value& byte) { return static_cast<std::uint8_t>(byte.as_int()); });
  return id;
}

std::optional<GoalId> split_goal_id(std::span<const std::byte> message, std::vector<std::byte>& part) {
  part.clear();
  if (message.size() < kEndOfGoalId) return {};
  GoalId id{};
  std::ranges::copy(message.subspan(kHeaderBytes, kIdBytes), std::as_writable_bytes(std::span(id)).begin());
  // Sixteen bytes later all alignments are the same.
  part.assign(message.begin(), message.begin() + kHeaderBytes);
  part.insert(part.end(), message.begin() + kEndOfGoalId, message.end());
  return id;
}

void put_goal_id(const GoalId& id, std::span<std::byte> bytes) {
  std::ranges::copy(bytes.subspan(kIdBytes, kHeaderBytes), bytes.begin());
  std::ranges::copy(std::as_bytes(std::span(id)), bytes.begin() + kHeaderBytes);
}

}  // namespace ros2

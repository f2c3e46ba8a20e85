// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../participant/participant.hpp"

#include <segue/base/log.hpp>
#include <segue/ros2/message_codec.hpp>

#include <chrono>
#include <memory>
#include <string>

namespace ros2 {

/// The topic /rosout: the last thousand lines, for 10 s.
class Rosout {
 public:
  struct Line {
    std::chrono::system_clock::time_point time{};
    segue::LogLevel level = segue::LogLevel::Info;
    std::string name;  ///< of the node, as rclcpp's loggers have it: "robot.drive"
    std::string message;
  };

  static segue::Result<std::unique_ptr<Rosout>> make(const std::shared_ptr<Participant>& participant);
  void publish(const Line& line);
  /// Whether there are subscriptions.
  [[nodiscard]] bool is_read() const;
  [[nodiscard]] segue::ros2::Gid publisher() const { return gid_of(writer_->guid()); }

 private:
  Rosout(segue::ros2::MessageCodec codec, Participant::Owned<dds::DataWriter> writer)
      : codec_(std::move(codec)), writer_(std::move(writer)) {}
  const segue::ros2::MessageCodec codec_;
  const Participant::Owned<dds::DataWriter> writer_;
};

/// The logger of a node: "robot.drive" for "/robot/drive".
std::string logger_of(const std::string& node);

}  // namespace ros2

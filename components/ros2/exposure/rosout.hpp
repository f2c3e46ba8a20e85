// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../participant/message_writer.hpp"
#include "../participant/participant.hpp"

#include <segue/base/log.hpp>

#include <chrono>
#include <memory>
#include <string>
#include <utility>

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
  [[nodiscard]] bool is_read() const { return writer_->is_read(); }
  [[nodiscard]] segue::ros2::Gid publisher() const { return writer_->gid(); }

 private:
  explicit Rosout(std::unique_ptr<MessageWriter> writer) : writer_(std::move(writer)) {}
  const std::unique_ptr<MessageWriter> writer_;
};

/// The logger of a node: "robot.drive" for "/robot/drive".
std::string logger_of(const std::string& node);

}  // namespace ros2

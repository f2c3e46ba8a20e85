// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/ros2/interface_library.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace segue::ros2 {

/// The bounds of a message's texts and sequences ("string<=10", "float64[<=3]"). Its type (message_type.hpp)
/// does not have them, but ROS 2's own nodes refuse to send longer sequences, and may fail to read them.
class MessageBounds {
 public:
  /// Of a message and its parts. Fails where message_type() does.
  static Result<MessageBounds> of(InterfaceLibrary& library, std::string_view name);

  /// Whether there are any. Without, each message keeps them, and need not be looked at.
  [[nodiscard]] bool any() const noexcept { return any_; }
  /// Whether a message keeps all of them; false also where it ends too early. `message` is its CDR in either
  /// byte order, with the header, and may be any bytes. Takes time for each of its fields, texts and nested
  /// messages, but not for each number. Allocates nothing. Any thread.
  [[nodiscard]] bool kept_by(std::span<const std::byte> message) const noexcept;
  /// The first one that a message does not keep, in words ("points[2].label: 12 bytes, but it is a
  /// string<=10"), or that it ends too early; empty where kept_by().
  [[nodiscard]] std::string broken_by(std::span<const std::byte> message) const;

 private:
  class Walk;
  struct Field {
    std::string name;
    FieldType type;
    std::size_t number = 0;               ///< the size of a number; 0 of texts and messages
    std::optional<std::size_t> nested{};  ///< its place among the messages
  };

  std::vector<std::vector<Field>> messages_;  ///< the whole one first
  bool any_ = false;
};

}  // namespace segue::ros2

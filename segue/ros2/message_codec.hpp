// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/ros2/interface_library.hpp>
#include <segue/ros2/message_bounds.hpp>
#include <segue/type/type_info.hpp>
#include <segue/type/value.hpp>

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace segue::ros2 {

/// All that is needed to send and receive a message: its type in this process, its names on DDS, and values
/// of it as CDR. Any thread.
class MessageCodec {
 public:
  /// Of a message such as "sensor_msgs/msg/LaserScan" or "std_srvs/srv/SetBool_Request". Fails where
  /// message_type() and make_type_info() do.
  static Result<MessageCodec> of(InterfaceLibrary& library, std::string_view name);

  [[nodiscard]] const type::TypeInfo& info() const { return *info_; }
  [[nodiscard]] const std::string& dds_type() const { return dds_type_; }
  [[nodiscard]] const std::string& type_hash() const { return type_hash_; }
  [[nodiscard]] const MessageBounds& bounds() const { return bounds_; }

  /// CDR of the value, with the header. Fields that it does not name have their defaults. `path` begins the
  /// error message where it does not fit the type; InvalidArgument also where a bound is exceeded.
  [[nodiscard]] Result<std::vector<std::byte>> encode(const type::Value& value, std::string_view path) const;
  /// ParseError where the bytes, which are untrusted, are not such a message.
  [[nodiscard]] Result<type::Value> decode(std::span<const std::byte> message) const;

 private:
  MessageCodec() = default;

  const type::TypeInfo* info_ = nullptr;
  std::string name_;
  std::string dds_type_;
  std::string type_hash_;
  MessageBounds bounds_;
};

}  // namespace segue::ros2

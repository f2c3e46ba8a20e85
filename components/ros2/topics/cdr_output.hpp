// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/ros2/message_codec.hpp>
#include <segue/task/any_port.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

namespace ros2 {

/// An output port whose samples come as CDR; a component makes it in on_configure.
class CdrOutput {
 public:
  enum class Outcome : std::uint8_t {
    Published,
    Refused,  ///< a connection had no room
    Corrupt,  ///< the message is not a sample of the type
    Lost      ///< there was no memory for it
  };

  /// `message` must outlive this. `topic`, `on_commit`: as those of PortOptions.
  CdrOutput(segue::task::Component& component, const std::string& name,
            const segue::ros2::MessageCodec& message, const std::string& doc, const std::string& topic = {},
            std::function<void()> on_commit = {});
  /// Whether samples reach nobody until the transition in progress has committed. The writer's thread only.
  [[nodiscard]] bool dormant() noexcept { return port_.dormant(); }
  /// Decodes the message, which is untrusted, to where readers find the sample. One thread at a time.
  Outcome publish(std::span<const std::byte> message) noexcept;
  /// publish() in two steps, between which the sample may be dropped. Empty: `why` says why there is none.
  segue::task::SampleRef make(std::span<const std::byte> message, Outcome& why) noexcept;
  Outcome publish(segue::task::SampleRef sample) noexcept;

 private:
  segue::task::SampleRef room_for(std::span<const std::byte> message, Outcome& why);
  bool decode(std::span<const std::byte> message, segue::task::SampleSlot& slot) const;

  const segue::type::TypeInfo& type_;
  segue::task::AnyOutput port_;
};

}  // namespace ros2

// SPDX-License-Identifier: Apache-2.0
//
// Messages of DDS that anybody on the network can send: what is handed on to Fast DDS is a message that it
// can read.
#include "require.hpp"

#include <segue/ros2/rtps_message.hpp>

#include <cstddef>
#include <cstdint>
#include <span>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using segue::fuzz::require;
  using segue::ros2::readable_by_fast_dds;
  const auto message = std::as_bytes(std::span(data, size));
  constexpr std::size_t kSmallestAcknowledgement = 12;
  require(segue::ros2::acknowledgements_in(message).size() <= size / kSmallestAcknowledgement,
          "each acknowledgement is a part of its own");
  const auto readable = readable_by_fast_dds(message);
  require(readable.bytes.empty() || readable.bytes.size() == size, "nothing moves");
  require(readable.refused.empty() || !readable.bytes.empty(), "what is refused is changed");
  require(readable_by_fast_dds(readable.bytes).bytes.empty(),
          "there is nothing to change in what was changed");
  return 0;
}

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace segue {

enum class BufferKind : std::uint8_t {
  Data,           ///< the newest value
  Buffer,         ///< `size` samples; when full, new ones are refused and counted
  CircularBuffer  ///< `size` samples; when full, the oldest is dropped and counted
};

inline constexpr std::array<std::string_view, 3> kBufferKindNames = {"data", "buffer", "circular_buffer"};
inline std::string_view to_string(BufferKind kind) {
  return kBufferKindNames.at(static_cast<std::size_t>(kind));
}

/// The link that carries a connection. Automatic: chosen by where the two tasks run.
enum class Transport : std::uint8_t { Automatic, Local, SharedMemory, Dds };

inline constexpr std::array<std::string_view, 4> kTransportNames = {"auto", "local", "shm", "dds"};
inline std::string_view to_string(Transport transport) {
  return kTransportNames.at(static_cast<std::size_t>(transport));
}

/// How samples are buffered between an output and an input port. Part of a connection's identity.
struct Policy {
  BufferKind kind = BufferKind::Data;
  std::size_t size = 1;  ///< samples; always 1 for Data
  Transport transport = Transport::Automatic;
  bool init = false;  ///< Data only: a new reader gets the last value written before it was connected

  friend bool operator==(const Policy&, const Policy&) = default;
  friend auto operator<=>(const Policy&, const Policy&) = default;
};

}  // namespace segue

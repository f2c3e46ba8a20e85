// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

/// The messages between a process server and its zygote; both are of the same version. Internal.
namespace segue::process_server::detail {

/// Longer than any title: a title is a part of the socket's path, whose length the system limits to 107.
inline constexpr std::size_t kTitleSize = 128;
/// The descriptors of a Launch request: output, assignment, listener, lock and output changes.
inline constexpr std::size_t kHandedDescriptors = 5;
inline constexpr std::string_view kZygoteOption = "--zygote";

enum class ZygoteRequestKind : std::uint32_t { Launch, Reap };

struct ZygoteRequest {
  ZygoteRequestKind kind = ZygoteRequestKind::Launch;
  std::int32_t pid = 0;                  ///< Reap
  std::array<char, kTitleSize> title{};  ///< Launch; zero-terminated
};

struct ZygoteReply {
  std::int32_t pid = 0;     ///< 0: it failed
  std::int32_t error = 0;   ///< errno where it failed
  std::int32_t code = 0;    ///< Reap: si_code of siginfo_t
  std::int32_t status = 0;  ///< Reap: si_status
};

/// Sends one message with descriptors. False where the other side is gone or does not take it in time.
bool send_message(int socket, const void* message, std::size_t size, std::span<const int> descriptors);
/// Receives one message. False where the other side is gone, does not answer in time, or sent another size.
bool receive_message(int socket, void* message, std::size_t size, std::vector<Descriptor>& descriptors);

}  // namespace segue::process_server::detail

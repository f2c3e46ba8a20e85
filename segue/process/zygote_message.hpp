// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

/// What a process server and its zygote say to each other; both are of one version. Internal.
namespace segue::process::detail {

/// Longer than any title: robot and process name the socket, whose path is shorter.
inline constexpr std::size_t kTitleSize = 128;
/// Output, assignment, listener and lock.
inline constexpr std::size_t kHandedDescriptors = 4;
inline constexpr std::string_view kZygoteOption = "--zygote";

enum class ZygoteRequestKind : std::uint32_t { Launch, Reap };

struct ZygoteRequest {
  ZygoteRequestKind kind = ZygoteRequestKind::Launch;
  std::int32_t pid = 0;                  ///< Reap
  std::array<char, kTitleSize> title{};  ///< Launch; ends with a zero
};

struct ZygoteReply {
  std::int32_t pid = 0;    ///< 0: it failed
  std::int32_t error = 0;  ///< errno then
  std::int32_t code = 0;   ///< of siginfo_t
  std::int32_t status = 0;
};

/// One message with descriptors. False where the other side is gone.
bool send_message(int socket, const void* message, std::size_t size, std::span<const int> descriptors);
/// False where the other side is gone, or what came is not of that size.
bool receive_message(int socket, void* message, std::size_t size, std::vector<Descriptor>& descriptors);

}  // namespace segue::process::detail

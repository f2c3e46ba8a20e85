// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/control/robot_lease.hpp>

#include <cstdint>
#include <string_view>
#include <vector>

namespace segue::runtime::detail {

/// Requests to the holder of a lease that it has not heard yet (control::RobotService::send_command).
/// Bounded: a holder that does not listen must not make it grow. Not thread safe; nothing blocks.
class HolderInbox {
 public:
  static constexpr std::size_t kMostWaiting = 16;
  static constexpr std::size_t kMostBreakpoints = 200;

  /// InvalidArgument where nobody can be asked for that, ResourceExhausted where too much waits. Of pause,
  /// resume and stop, of breakpoints, and of values, the latest counts.
  Result<std::uint64_t> put(std::string_view what, const type::Value& arguments);
  std::vector<control::HolderRequest> take();

 private:
  std::uint64_t asked_ = 0;
  std::vector<control::HolderRequest> waiting_;
};

}  // namespace segue::runtime::detail

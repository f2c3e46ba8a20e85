// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/base/wait.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace segue::control {

/// A request to the holder of a lease.
struct HolderRequest {
  std::uint64_t number = 0;  ///< rising over all that this holder has been asked
  std::string what;
  type::Value arguments;  ///< null, or a map
  friend bool operator==(const HolderRequest&, const HolderRequest&) = default;
};

/// Whether the holder of a lease still commands the robot.
struct LeaseStanding {
  std::optional<std::string> lost_to{};  ///< who took the robot over
  bool is_stopped = false;               ///< the robot comes to rest; the holder only says how it ends
  friend bool operator==(const LeaseStanding&, const LeaseStanding&) = default;
};

/// The right of one holder to request controllers and to apply files: while it is held, requests of others
/// are refused, unless they take the robot over. Has ended when its destructor returns; ends, too, with the
/// holder's connection.
class RobotLease {
 public:
  virtual ~RobotLease() = default;
  [[nodiscard]] virtual std::uint64_t number() const = 0;
  /// Whether the holder still commands the robot; a call that only looks, like those of RobotService.
  virtual Result<LeaseStanding> standing(const Wait& wait) = 0;
  Result<LeaseStanding> standing() { return standing(Wait(TimePoint::max())); }
  /// The requests to its holder since the last call (RobotService::send_command), oldest first.
  virtual Result<std::vector<HolderRequest>> asked() = 0;
};

}  // namespace segue::control

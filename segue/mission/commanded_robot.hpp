// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/mission/controller_use.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace segue::mission {

/// What a task of the robot says of itself.
struct TaskView {
  std::string state;       ///< "running", "stopped", ...
  std::string state_name;  ///< one that its component declares ("arrived"); may be empty
  std::uint64_t updates = 0;
};

/// Samples of a port, for one reader.
class PortSamples {
 public:
  virtual ~PortSamples() = default;
  /// Those that came since the last call, oldest first. Does not wait for any.
  virtual Result<std::vector<type::Value>> take() = 0;
};

/// The robot as missions command it: it runs in this process or in another one, or is simulated. Functions
/// may be called from any thread; they block until the robot has answered, until their deadline at most where
/// they have one.
class CommandedRobot {
 public:
  virtual ~CommandedRobot() = default;

  /// Has the robot run that controller; "": none. Returns once it runs; the error says why it does not, and
  /// what the robot runs then is as before.
  virtual Result<void> request(std::string_view controller, TimePoint deadline) = 0;
  /// Why the robot does not run that controller as it should: another one runs, or what failed of it could
  /// not be repaired. Empty: it does.
  virtual Result<std::string> trouble(std::string_view controller) = 0;
  virtual Result<void> set(const Member& property, const type::Value& value, TimePoint deadline) = 0;
  virtual Result<type::Value> call(const Member& operation, const type::Value& arguments,
                                   TimePoint deadline) = 0;
  virtual Result<TaskView> task(std::string_view id) = 0;
  /// The latest samples of an output port from now on.
  virtual Result<std::unique_ptr<PortSamples>> open(const Member& port) = 0;
};

}  // namespace segue::mission

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/life_cycle.hpp>
#include <segue/base/log.hpp>
#include <segue/base/result.hpp>
#include <segue/control/robot_service.hpp>
#include <segue/type/value.hpp>

#include <atomic>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

namespace ros2 {

/// One that may be called in any thread.
using LogFunction = std::function<void(segue::LogLevel level, const std::string& message)>;

/// The limits of what clients of ROS 2 may do with exposed tasks.
struct ExposureRules {
  bool writable = false;  ///< set properties, and call operations
  std::string who{};      ///< sets and calls, for the robot's journal
  LogFunction log{};
};

/// A task of a robot, as the services of its node use it: each function has the response to a request.
class ExposedTask {
 public:
  using Value = segue::type::Value;
  /// Nothing is set or called once a stop is requested.
  ExposedTask(std::shared_ptr<segue::control::RobotService> robot, std::string id, ExposureRules rules,
              std::stop_token stop);

  [[nodiscard]] const std::string& id() const { return id_; }
  [[nodiscard]] bool is_writable() const { return rules_.writable; }
  [[nodiscard]] segue::TaskState state() const { return state_; }
  void set_state(segue::TaskState state) { state_ = state; }

  /// As the robot reports it now. Null, which is logged, where it cannot be asked.
  [[nodiscard]] Value report() const;
  /// Those without arguments, by name.
  [[nodiscard]] std::vector<std::string> operations() const;

  [[nodiscard]] Value describe(const Value& request) const;
  Value set_parameters(const Value& request);
  Value set_parameters_atomically(const Value& request);
  Value change_state(const Value& request);
  Value call(const std::string& operation);

 private:
  struct Setting {
    std::string name;
    Value value;   ///< of the property
    Value before;  ///< its present one
  };
  /// Whether a client may set that, as rcl_interfaces/msg/Parameter says it; `report`: of the task.
  [[nodiscard]] segue::Result<Setting> check(const Value& parameter, const Value& report) const;
  segue::Result<void> set(const std::string& name, const Value& value, segue::TimePoint deadline);
  [[nodiscard]] segue::control::Sender sender() const;

  const std::shared_ptr<segue::control::RobotService> robot_;
  const std::string id_;
  const ExposureRules rules_;
  const std::stop_token stop_;
  std::atomic<segue::TaskState> state_{segue::TaskState::PreOperational};
};

}  // namespace ros2

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/control/robot_service.hpp>
#include <segue/mission/commanded_robot.hpp>

#include <string>

/// Robots as missions command them.
namespace segue::robot {

/// A robot that offers a RobotService: one in another process (control::connect), or in this one
/// (runtime::RuntimeService). Thread safe.
class ServedRobot final : public mission::CommandedRobot {
 public:
  /// `service` must outlive this; `who` requests controllers, for the robot's journal.
  ServedRobot(control::RobotService& service, std::string who) : service_(service), who_(std::move(who)) {}

  Result<void> request(std::string_view controller, TimePoint deadline) override;
  Result<std::string> trouble(std::string_view controller) override;
  Result<void> set(const mission::Member& property, const type::Value& value, TimePoint deadline) override;
  Result<type::Value> call(const mission::Member& operation, const type::Value& arguments,
                           TimePoint deadline) override;
  Result<mission::TaskView> task(std::string_view id) override;
  Result<std::unique_ptr<mission::PortSamples>> open(const mission::Member& port) override;

 private:
  control::RobotService& service_;
  const std::string who_;
};

}  // namespace segue::robot

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/commanded_robot.hpp>

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace segue::testing {

/// Forwards everything to another robot; tests override the functions that they look at or disturb.
class ForwardingCommandedRobot : public mission::CommandedRobot {
 public:
  explicit ForwardingCommandedRobot(std::shared_ptr<mission::CommandedRobot> inner)
      : inner_(std::move(inner)) {}

  Result<void> request(const mission::ControllerRequest& what, const Wait& wait) override {
    return inner_->request(what, wait);
  }
  Result<mission::ControllerTrouble> trouble(std::string_view controller, const Wait& wait) override {
    return inner_->trouble(controller, wait);
  }
  Result<mission::ControllerConflicts> conflicts(const Wait& wait) override {
    return inner_->conflicts(wait);
  }
  Result<std::vector<mission::PoolView>> pools(const Wait& wait) override { return inner_->pools(wait); }
  void take_instance(const model::InstanceQuestion& what, const Wait& wait,
                     model::InstanceAnswer answered) override {
    inner_->take_instance(what, wait, std::move(answered));
  }
  Result<void> prepare(const std::vector<std::string>& controllers, const Wait& wait) override {
    return inner_->prepare(controllers, wait);
  }
  Result<type::Value> call(const mission::Member& operation, const type::Value& arguments,
                           const Wait& wait) override {
    return inner_->call(operation, arguments, wait);
  }
  Result<void> set(const mission::Member& property, const type::Value& value, const Wait& wait) override {
    return inner_->set(property, value, wait);
  }
  Result<void> write(const mission::Member& port, const type::Value& value, const Wait& wait) override {
    return inner_->write(port, value, wait);
  }
  void watch(const mission::TaskQuestion& question, const Wait& wait, mission::TaskAnswer answered) override {
    inner_->watch(question, wait, std::move(answered));
  }
  void changes(std::uint64_t seen, const Wait& wait, mission::ChangesAnswer answered) override {
    inner_->changes(seen, wait, std::move(answered));
  }
  Result<std::unique_ptr<mission::PortSamples>> open(const mission::Member& port, const Wait& wait) override {
    return inner_->open(port, wait);
  }

 protected:
  const std::shared_ptr<mission::CommandedRobot> inner_;
};

}  // namespace segue::testing

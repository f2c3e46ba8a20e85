// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../services/requester.hpp"

#include <segue/base/result.hpp>
#include <segue/type/value.hpp>

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace ros2 {

/// Asks for parameters of a node of ROS 2, and sets them. Any thread.
class ParameterClient {
 public:
  /// `node`: "/robot/talker". Fails as Requester::make() does.
  static segue::Result<std::unique_ptr<ParameterClient>> make(const std::shared_ptr<Participant>& participant,
                                                              const std::string& node);
  /// All or none of them (rcl_interfaces/srv/SetParametersAtomically). InvalidArgument with the node's
  /// reason, else as Requester::call().
  segue::Result<void> set(const segue::type::Value& request, segue::TimePoint deadline);
  /// Their values, as rcl_interfaces/msg/ParameterValue; null where the node tells none. Fails as
  /// Requester::call().
  segue::Result<std::vector<segue::type::Value>> get(const std::vector<std::string>& names,
                                                     segue::TimePoint deadline);
  /// Calls in progress and later ones end at once.
  void cancel() {
    set_->allow(false);
    get_->allow(false);
  }
  [[nodiscard]] std::array<const Requester*, 2> requesters() const { return {set_.get(), get_.get()}; }

 private:
  ParameterClient() = default;

  std::string node_;
  std::unique_ptr<Requester> set_;
  std::unique_ptr<Requester> get_;
};

}  // namespace ros2

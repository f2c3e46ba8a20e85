// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../services/requester.hpp"

#include <segue/base/result.hpp>
#include <segue/type/value.hpp>

#include <memory>
#include <string>

namespace ros2 {

/// Sets parameters of a node of ROS 2. Any thread.
class ParameterClient {
 public:
  /// `node`: "/robot/talker". Fails as Requester::make() does.
  static segue::Result<std::unique_ptr<ParameterClient>> make(const std::shared_ptr<Participant>& participant,
                                                              const std::string& node);
  /// All or none of them (rcl_interfaces/srv/SetParametersAtomically). InvalidArgument with the node's
  /// reason, else as Requester::call().
  segue::Result<void> set(const segue::type::Value& request, segue::TimePoint deadline);
  /// Calls in progress and later ones end at once.
  void cancel() { set_->allow(false); }
  [[nodiscard]] const Requester& requester() const { return *set_; }

 private:
  ParameterClient() = default;

  std::string node_;
  std::unique_ptr<Requester> set_;
};

}  // namespace ros2

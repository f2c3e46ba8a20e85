// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>
#include <segue/model/network.hpp>

#include <functional>
#include <optional>

namespace segue::distributed::detail {

/// Knows whether another runtime has got the robot. One host that says so suffices, for all of them and for
/// good. Thread safe.
class RobotLoss {
 public:
  /// `lost` is called once, by whichever thread notes it first; must not block.
  explicit RobotLoss(std::function<void(const Error& why)> lost) : lost_(std::move(lost)) {}

  /// Notes the error that a host has answered; errors other than Superseded do not mean that the robot is
  /// lost.
  void note(const model::HostName& host, const Error& error);
  /// Nothing: the robot is not lost.
  [[nodiscard]] std::optional<Error> why() const;

 private:
  const std::function<void(const Error&)> lost_;
  mutable Mutex mutex_;  ///< protects the member below
  std::optional<Error> why_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::distributed::detail

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>
#include <segue/control/robot_service.hpp>

#include <cstdint>
#include <functional>
#include <memory>

namespace segue::web {

using Connect = std::function<Result<std::unique_ptr<control::RobotService>>()>;

/// A connection to a robot that is made when it is needed, and again after it was lost. All functions may be
/// called from any thread.
class RobotLink {
 public:
  struct Connected {
    std::shared_ptr<control::RobotService> robot;
    std::uint64_t generation = 0;  ///< counts connections
  };

  /// `connect` is tried at most once in `pause`; the last error is answered in between.
  explicit RobotLink(Connect connect, Duration pause = std::chrono::milliseconds(300));

  Result<Connected> get();
  /// A call of that connection failed: where the robot cannot be reached any more, the next get() connects
  /// anew.
  void failed(std::uint64_t generation, const Error& error);

 private:
  const Connect connect_;
  const Duration pause_;
  Mutex mutex_;  ///< protects all below
  Connected connected_ SEGUE_GUARDED_BY(mutex_);
  std::uint64_t generations_ SEGUE_GUARDED_BY(mutex_) = 0;
  Error last_error_ SEGUE_GUARDED_BY(mutex_);
  TimePoint next_try_ SEGUE_GUARDED_BY(mutex_){};
};

}  // namespace segue::web

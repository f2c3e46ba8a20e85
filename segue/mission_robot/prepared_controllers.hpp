// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/mission/commanded_robot.hpp>
#include <segue/mission_robot/upcoming_controllers.hpp>

#include <cstdint>
#include <map>
#include <memory>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

namespace segue::mission {

/// Has a robot prepare the controllers that lie ahead of the actions that run now. Thread safe; nothing here
/// blocks but the destructor, until the robot has heard that none of them is to be kept any more.
class PreparedControllers {
 public:
  /// `most`: how many at once; 0: never any.
  PreparedControllers(std::shared_ptr<CommandedRobot> robot, std::size_t most, Duration deadline);
  ~PreparedControllers();
  PreparedControllers(const PreparedControllers&) = delete;
  PreparedControllers& operator=(const PreparedControllers&) = delete;

  /// The action number `action` runs `controller`, and these lie ahead of it.
  void began(std::uint64_t action, std::string controller, std::vector<UpcomingController> ahead);
  /// The action has ended. Controllers that lay ahead of it remain prepared until another one begins.
  void ended(std::uint64_t action);

 private:
  struct Running {
    std::string controller;
    std::vector<UpcomingController> ahead;
    bool has_ended = false;
  };

  void work(const std::stop_token& stop);
  [[nodiscard]] std::vector<std::string> likeliest() const SEGUE_REQUIRES(mutex_);

  const std::shared_ptr<CommandedRobot> robot_;
  const std::size_t most_;
  const Duration deadline_;
  Mutex mutex_;  ///< protects the next two
  StoppableConditionVariable changed_;
  std::map<std::uint64_t, Running> running_ SEGUE_GUARDED_BY(mutex_);
  std::vector<std::string> prepared_;  ///< that the robot was asked for last; used by the thread only
  std::jthread thread_;
};

}  // namespace segue::mission

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/question.hpp>
#include <segue/base/result.hpp>
#include <segue/mission/commanded_robot.hpp>
#include <segue/mission_robot/change_watch.hpp>
#include <segue/mission_robot/controller_union.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace segue::mission {

/// Checks whether the robot runs the controller of an action as it should: asks the robot only where
/// something has changed since, and tells the union when it does. One thread uses this.
class WatchedController {
 public:
  /// `robot` and `controllers` must outlive this. News ring `bell`.
  WatchedController(CommandedRobot& robot, ControllerUnion& controllers, std::string controller,
                    std::shared_ptr<Bell> bell)
      : robot_(robot),
        controllers_(controllers),
        controller_(std::move(controller)),
        changes_(robot, std::move(bell)) {}

  /// Has the robot say when something changes, unless it has been asked already.
  void ask() { changes_.ask(); }
  /// Whether something may have changed since the last call.
  [[nodiscard]] bool may_have_changed() { return changes_.take(); }
  /// When ask() has something to do although the bell does not ring.
  [[nodiscard]] TimePoint next_question() const { return changes_.next_question(); }

  /// Asks the robot.
  Result<ControllerTrouble> trouble(const Wait& wait);
  /// Whether this answer of a task implies that the controller runs well, too: nothing had changed since the
  /// robot was asked. Asks nothing.
  bool ran_well_when(const TaskView& heard);

 private:
  /// The robot was asked, and ran it as it should.
  struct RanWell {
    std::uint64_t changes;  ///< counted by then, at least
    TimePoint asked;
  };

  CommandedRobot& robot_;
  ControllerUnion& controllers_;
  const std::string controller_;
  ChangeWatch changes_;
  std::optional<RanWell> well_;
};

}  // namespace segue::mission

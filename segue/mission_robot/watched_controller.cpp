// SPDX-License-Identifier: Apache-2.0
#include <segue/mission_robot/watched_controller.hpp>

namespace segue::mission {

Result<ControllerTrouble> WatchedController::trouble(const Wait& wait) {
  const RanWell now{changes_.seen(), RealClock::instance().now()};  // as of before it is asked
  well_.reset();
  auto trouble = robot_.trouble(controller_, wait);
  if (trouble && trouble->runs_well()) {
    controllers_.note_runs(controller_, now.asked, now.asked);
    well_ = now;
  }
  return trouble;
}

bool WatchedController::ran_well_when(const TaskView& heard) {
  const bool nothing_has_changed = well_ && well_->changes != 0 && heard.changes == well_->changes;
  if (nothing_has_changed) controllers_.note_runs(controller_, well_->asked, RealClock::instance().now());
  return nothing_has_changed;
}

}  // namespace segue::mission

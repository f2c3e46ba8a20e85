// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/mission_robot/controller_runner.hpp>
#include <segue/mission_run/loaded_mission.hpp>
#include <segue/remote_robot/served_robot.hpp>

#include <memory>

#include "command.hpp"
#include "mission_request.hpp"

namespace segue::cli {

/// Lets the robot carry out actions that are controllers or calls of pools, and compares observed facts with
/// it. A pool has as many units as it may have instances, unless the request has given another number.
Result<void> run_by_robot(mission_run::RunRequest& request, const mission_run::LoadedMission& plan,
                          const std::shared_ptr<remote_robot::ServedRobot>& robot,
                          const mission::ControllerOptions& how);

/// Runs a mission or a task network and shows what it did. SIGINT and SIGTERM preempt it. Controllers are
/// those of the running robot that the context names.
int run_plan(const MissionOptions& options, const NetworkOptions& network, Context& context);

}  // namespace segue::cli

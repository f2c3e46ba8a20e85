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

/// The robot carries out what of the mission is a controller or a call of a pool, and is what observed facts
/// are compared with. There are as many units of a pool as instances, unless the request has said how many.
Result<void> run_by_robot(mission_run::RunRequest& request, const mission_run::LoadedMission& plan,
                          const std::shared_ptr<remote_robot::ServedRobot>& robot,
                          const mission::ControllerOptions& how);

/// Runs a mission or a task network and shows what it did. SIGINT and SIGTERM preempt it. Controllers are
/// those of the running robot that the context names.
int run_plan(const MissionOptions& options, const NetworkOptions& network, Context& context);

}  // namespace segue::cli

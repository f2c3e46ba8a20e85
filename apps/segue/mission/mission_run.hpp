// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/mission_robot/controller_runner.hpp>
#include <segue/mission_robot/controller_union.hpp>
#include <segue/mission_run/loaded_mission.hpp>
#include <segue/remote_robot/served_robot.hpp>

#include <atomic>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>

#include "../command.hpp"
#include "../stop_signal.hpp"
#include "mission_remote.hpp"
#include "mission_request.hpp"

namespace segue::cli {

using Ran = Result<std::unique_ptr<mission_run::FinishedRun>>;

/// Lets the robot carry out actions that are controllers or calls of pools, and compares observed facts with
/// it. A pool has as many units as it may have instances, unless the request has given another number.
/// `controllers`: those that the robot runs for an earlier mission; null: none.
Result<void> run_by_robot(mission_run::RunRequest& request, const mission_run::LoadedMission& plan,
                          const std::shared_ptr<remote_robot::ServedRobot>& robot,
                          const mission::ControllerOptions& how,
                          std::shared_ptr<mission::ControllerUnion> controllers = nullptr);

/// A robot that missions command, one after another. What one of them leaves running (`afterwards: keep`)
/// runs on until a later one needs the robot in a way that conflicts with it. For the thread that creates it.
class MissionRobot {
 public:
  /// SIGINT and SIGTERM request a stop, and the end of `input`, unless that is -1. `verb` commands the robot,
  /// for its journal. `stops_if_unreachable`: a run is stopped, rather than that its actions abort, where the
  /// robot cannot be reached any more.
  MissionRobot(control::RobotService& service, std::string_view verb, mission::ControllerOptions how,
               bool stops_if_unreachable, int input = -1);

  /// Takes the robot's lease, unless this has it, which it keeps until leave().
  Result<mission::ControllerConflicts> take();
  /// Runs a mission; an error where it could not begin. Others see and steer it through the robot, until the
  /// next one runs or the robot is left: meanwhile they can only stop it. `steering`, which is that of the
  /// request, must outlive this.
  Ran run(const mission_run::LoadedMission& plan, mission_run::RunRequest request,
          mission_run::RunControl& steering, const MissionOptions& options, const Context& context);
  /// Gives the robot back, which runs on (`keep`) or comes to rest; that is waited for, and false where it
  /// does not.
  bool leave(bool keep, const std::string& name);

  /// Requested by a signal, by `segue mission stop`, and where the robot is halted.
  [[nodiscard]] std::stop_token stop() const { return stop_.get_token(); }
  [[nodiscard]] bool is_unreachable() const { return *is_unreachable_; }
  [[nodiscard]] const std::shared_ptr<remote_robot::ServedRobot>& robot() const { return robot_; }

 private:
  struct Stopping {
    std::stop_source stop;
    void operator()() { stop.request_stop(); }
  };
  StopSignal signal_;
  std::stop_source stop_;
  const std::stop_callback<Stopping> stopping_{signal_.token(), Stopping{stop_}};
  const std::shared_ptr<std::atomic<bool>> is_unreachable_ = std::make_shared<std::atomic<bool>>(false);
  const std::shared_ptr<remote_robot::ServedRobot> robot_;
  mission::ControllerOptions how_;
  const std::shared_ptr<mission::ControllerUnion> controllers_;
  std::optional<MissionRemote> remote_;  ///< of the last mission
};

/// The document of a run, with what look-ahead saved if that is known. `robot`: on which it ran; null: on
/// none.
type::Value document_of(mission_run::FinishedRun& run, const remote_robot::ServedRobot* robot);
/// Prints it, or the document. `robot` as above; `follows`: the document in one line.
void show_run(mission_run::FinishedRun& run, bool is_network, bool follows,
              const remote_robot::ServedRobot* robot, const Context& context);

/// Runs a mission or a task network and shows what it did. SIGINT and SIGTERM preempt it. Controllers are
/// those of the running robot that the context names.
int run_plan(const MissionOptions& options, const NetworkOptions& network, Context& context);

}  // namespace segue::cli

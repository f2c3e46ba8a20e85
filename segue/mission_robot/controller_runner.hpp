// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/mission/action_runner.hpp>
#include <segue/mission/commanded_robot.hpp>
#include <segue/mission_robot/controller_union.hpp>

#include <functional>
#include <memory>
#include <optional>

namespace segue::mission {

/// How often a robot is looked at and how long it is waited for while it carries out actions.
struct ControllerOptions {
  /// How often ports are read for outputs that have not come yet. The robot reports what ends an action:
  /// states of tasks when they change, samples when they come, every 10 ms at most; operations are called
  /// after updates of their tasks, every 10 ms at most.
  Duration period = std::chrono::milliseconds(20);
  /// How many controllers are kept prepared for what the mission does next, at most; 0: none. The robot's
  /// budget limits them, too.
  std::size_t look_ahead = 3;
  /// For a request, and for everything else that the robot is asked.
  Duration request_deadline = std::chrono::seconds(60);
  Duration answer_deadline = std::chrono::seconds(10);
  /// How long it may take the robot to notice that a task is gone, and to run it after its repair.
  Duration notice = std::chrono::seconds(3);
  /// Called, on some thread, where the robot cannot be reached any more: then the run must be stopped, so
  /// that it can be resumed when the robot is back, and actions end as it preempts them. Null: they abort.
  std::function<void(const Error& why)> unreachable{};
};

/// Carries out actions that are controllers (ControllerUse), each in a thread of its own. An action aborts
/// where the robot refuses what it is asked, and where its controller is replaced or fails: no action
/// succeeds without its controller. Conditions on a task and on its ports count from its first update after
/// it got its commands, so a state that belongs to an earlier goal does not end the action.
///
/// Where a task that it watches is gone and the robot repairs it, an action waits as long as the repair goes
/// on, which its robot limits, or until its own time is up. Tasks that have begun anew get their commands
/// again. The action aborts where the repair is given up.
///
/// Actions whose controllers can run at once do (ControllerUnion). While they run, the controllers that the
/// mission is likely to need next are prepared (upcoming_controllers).
///
/// In a run with a journal, an action records when it begins to give commands to its tasks, and when it has
/// given them. In between it cannot be resumed; before, it begins anew; afterwards it is only watched, if its
/// controller still runs. States then count from the time of the commands; times and samples count anew.
class ControllerRunner final : public ActionRunner {
 public:
  /// `controllers`: shared with a ScriptRobot; null: one of its own.
  explicit ControllerRunner(std::shared_ptr<CommandedRobot> robot, const ControllerOptions& options = {},
                            std::shared_ptr<ControllerUnion> controllers = nullptr);
  /// Ends what is under way as preempted; blocks until the robot has answered.
  ~ControllerRunner() override;
  ControllerRunner(const ControllerRunner&) = delete;
  ControllerRunner& operator=(const ControllerRunner&) = delete;

  std::optional<Ending> start(ActionCall& call) override;
  Result<void> go_on(const Action& action, const type::Value& progress) override;

 private:
  class Implementation;
  const std::unique_ptr<Implementation> implementation_;
};

}  // namespace segue::mission

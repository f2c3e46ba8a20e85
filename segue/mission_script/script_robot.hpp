// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/mission/action_runner.hpp>
#include <segue/mission/commanded_robot.hpp>
#include <segue/mission_robot/controller_union.hpp>

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace segue::mission {

class ExecutionThreads;

/// How long it may take until what a script looks at counts as lost.
struct ScriptRobotOptions {
  /// Called where the robot cannot be reached any more; see ControllerOptions::unreachable.
  std::function<void(const Error& why)> unreachable{};
  /// How long it may take the robot to notice that a task is gone which a script looks at.
  Duration notice = std::chrono::seconds(3);
  /// How often to look whether a task that was lost is there again.
  Duration period = std::chrono::milliseconds(50);
};

/// The robot as scripts command it (`self.robot`, docs/robot_missions.md): controllers are requested together
/// with those of other actions, and a script whose controller is lost is preempted and aborts. Requests of
/// scripts are carried out in threads of this class. Thread safe.
class ScriptRobot {
 public:
  /// One execution's rights and its use of the robot.
  class Use;
  /// The rights of one script on the robot.
  struct Rights {
    bool may_command = false;              ///< else it only looks, and calls operations
    std::vector<std::string> controllers;  ///< that it may request
    ControllerUser user{};                 ///< the action of the script
  };
  using Answered = std::function<void(type::ValueMap answer)>;

  /// `controllers`: shared with the ControllerRunner of the same run.
  ScriptRobot(std::shared_ptr<CommandedRobot> robot, std::shared_ptr<ControllerUnion> controllers,
              ScriptRobotOptions options = {});
  /// Blocks until the robot has answered what scripts have asked.
  ~ScriptRobot();
  ScriptRobot(const ScriptRobot&) = delete;
  ScriptRobot& operator=(const ScriptRobot&) = delete;

  /// `preempt` is called once, on some thread, where the script is to end since a controller was lost. This
  /// must outlive the use.
  std::shared_ptr<Use> begin(Rights rights, std::function<void()> preempt);

 private:
  const std::shared_ptr<CommandedRobot> robot_;
  const std::shared_ptr<ControllerUnion> controllers_;
  const ScriptRobotOptions options_;
  const std::unique_ptr<ExecutionThreads> threads_;  // destroyed first: they use the others
};

/// Functions may be called from any thread, and do not block.
class ScriptRobot::Use : public std::enable_shared_from_this<Use> {
 public:
  virtual ~Use() = default;
  /// Carries out a request of a script: "call" is one of call, set, write, read, task, request and release.
  /// `answered` gets "value", or "error" and "code", on some thread.
  virtual void ask(type::Value request, Answered answered) = 0;
  /// Ends all waits for the robot with Cancelled. Afterwards the script may only look at the robot and
  /// release controllers; other requests are Cancelled, too, since an action that was preempted commands
  /// nothing any more.
  virtual void preempt() = 0;
  /// The script has ended: gives back the controllers that it still uses, and then calls `ended` on some
  /// thread with the execution's ending: no script succeeds whose controller was lost.
  virtual void end(Ending ending, std::function<void(Ending)> ended) = 0;
};

}  // namespace segue::mission

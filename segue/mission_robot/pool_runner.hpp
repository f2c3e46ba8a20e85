// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/mission/action_runner.hpp>
#include <segue/mission/commanded_robot.hpp>

#include <functional>
#include <memory>
#include <optional>

namespace segue::mission {

/// How long it may take until an instance counts as lost.
struct PoolOptions {
  /// How often it is looked whether an instance that did not answer is lost.
  Duration period = std::chrono::milliseconds(50);
  /// How long it may take the robot to notice that an instance is lost whose connection broke.
  Duration notice = std::chrono::seconds(3);
  /// Called where the robot cannot be reached any more; see ControllerOptions::unreachable.
  std::function<void(const Error& why)> unreachable{};
};

/// Carries out actions that are calls of a pool of processes (PoolCall), each in a thread of its own and on
/// an instance that the robot gives it, which works for nobody else. Where an instance is lost while it works
/// for a pure action, another one takes its place: as often as the pool may have instances. An action
/// that is preempted ends at once; its instance is free again when it has answered, which is dropped. An
/// instance that has not answered when nobody waits for it any more is ended by the robot, and free when it
/// has been started again.
class PoolRunner final : public ActionRunner {
 public:
  explicit PoolRunner(std::shared_ptr<CommandedRobot> robot, const PoolOptions& options = {});
  /// Ends what is under way as preempted; waits for no instance.
  ~PoolRunner() override;
  PoolRunner(const PoolRunner&) = delete;
  PoolRunner& operator=(const PoolRunner&) = delete;

  std::optional<Ending> start(ActionCall& call) override;

 private:
  class Implementation;
  const std::unique_ptr<Implementation> implementation_;
};

}  // namespace segue::mission

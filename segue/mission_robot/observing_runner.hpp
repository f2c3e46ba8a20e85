// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/action_runner.hpp>
#include <segue/mission_robot/fact_observer.hpp>

#include <memory>
#include <optional>

namespace segue::mission {

/// Compares the observed facts that actions declare with the robot, and leaves everything else to another
/// runner. An action whose precondition does not hold does not begin; one that loses a fact of its `while` is
/// preempted; one that ended as expected waits until its effects show. Where these do not show in time, it
/// aborts.
class ObservingRunner final : public ActionRunner {
 public:
  ObservingRunner(std::shared_ptr<ActionRunner> inner, std::shared_ptr<FactObserver> observer)
      : inner_(std::move(inner)), observer_(std::move(observer)) {}

  [[nodiscard]] Result<void> check() const override { return inner_->check(); }
  std::optional<Ending> start(ActionCall& call) override;

 private:
  const std::shared_ptr<ActionRunner> inner_;
  const std::shared_ptr<FactObserver> observer_;
};

}  // namespace segue::mission

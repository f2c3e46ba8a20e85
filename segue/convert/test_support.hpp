// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/convert/concurrent_run.hpp>
#include <segue/mission/mission_io.hpp>

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

/// Short ways to run missions in tests.
namespace segue::convert::testing {

inline std::shared_ptr<const mission::Program> program(const std::string& text) {
  Diagnostics diagnostics;
  auto mission = mission::read_mission(text, "mission.yaml", diagnostics);
  EXPECT_TRUE(mission) << to_string(diagnostics);
  return mission::Program::compile(std::move(*mission)).value();
}

/// A run in virtual time.
class VirtualRun {
 public:
  explicit VirtualRun(const std::string& text, RunOptions options = {}, mission::Runners runners = {}) {
    options.clock = task_network::ClockKind::Virtual;
    run_ = Run::create(program(text), runners, {}, options).value();
    result = run_->run();
  }

  /// "path: outcome, BEGIN to END" in seconds, for each action that began, in program order.
  [[nodiscard]] std::vector<std::string> executions() const {
    std::vector<std::string> lines;
    const auto& nodes = run_->network_result().nodes;
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
      const task_network::NodeId node{i};
      const task_network::NodeStatus status = nodes[i].status;
      const bool counts =
          status != task_network::NodeStatus::Skipped && status != task_network::NodeStatus::NotReached;
      if (!counts || (plan()[node].role != Role::Action && plan()[node].role != Role::OpaqueSubtree))
        continue;
      const mission::Outcome outcome = plan().outcome(node, nodes[i].outcome);
      lines.push_back(std::string(plan()[node].path) + ": " +
                      plan().program().outcome_name(plan()[node].state, outcome) + ", " +
                      seconds(nodes[i].started) + " to " + seconds(nodes[i].ended));
    }
    return lines;
  }
  [[nodiscard]] const MissionPlan& plan() const { return run_->plan(); }
  [[nodiscard]] const task_network::Order& order() const { return run_->order(); }
  [[nodiscard]] const mission::Globals& globals() const { return run_->globals(); }
  [[nodiscard]] const task_network::RunResult& network_result() const { return run_->network_result(); }

  mission::MissionResult result;

 private:
  static std::string seconds(TimePoint time) {
    return std::to_string(time.time_since_epoch() / std::chrono::seconds(1));
  }

  std::unique_ptr<Run> run_;
};

}  // namespace segue::convert::testing

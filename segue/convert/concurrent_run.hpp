// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/convert/mission_plan.hpp>
#include <segue/mission_engine/engine.hpp>

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace segue::convert {

struct RunOptions {
  task_network::ClockKind clock = task_network::ClockKind::Real;
  bool strict = false;             ///< all nodes are strict (task_network::NodeSpec::strict)
  bool speculate = true;           ///< pure actions run ahead
  std::uint32_t workers = 0;       ///< actions that run at the same time; 0: any number
  std::uint32_t world_copies = 0;  ///< projected worlds at the same time; 0: any number
  std::uint32_t ahead = 0;         ///< actions that run ahead at the same time; 0: any number
  double least_likelihood = 0;     ///< what is less likely to count does not run ahead; of 1
  std::size_t horizon = 1000;      ///< unfinished nodes that are planned ahead
  bool log = false;                ///< record events in the result of the network
  Duration preemption_grace = std::chrono::seconds(10);  ///< as in mission::EngineOptions
  std::vector<mission::Fact> facts{};                    ///< likewise
  mission::UnitCounts resources{};                       ///< likewise
  mission::AttachedData world_data{};                    ///< likewise
  std::function<void(std::string)> warn;                 ///< likewise
  /// Called for every action and container that begins, and for every one whose end counts: those that run
  /// ahead and are discarded begin only; one that may not begin has an end only. One call at a time, but
  /// what is in opaque subtrees reports from other threads.
  mission::StateObserver observe{};
  /// As in mission::EngineOptions. An opaque subtree is one execution. Called on the engine's thread.
  mission::UnitObserver observe_units{};
  /// Records the run, or supplies what an earlier one did; created with RunJournal::Start::concurrent.
  std::shared_ptr<mission::RunJournal> journal{};
  /// Called on the thread of run() when it is paused and nothing runs any more, with the paths of the actions
  /// that could begin.
  std::function<void(const std::vector<std::string>& next)> held{};
};

/// Runs a mission concurrently, with the outcome of its sequential run (docs/missions.md); where it fails,
/// what ahead_of_failures() lists may have been done besides. Runs once. For one thread, except stop().
class Run {
 public:
  /// `inputs` by port of the mission, null for its default. NotFound if an action has no runner; otherwise
  /// fails as Plan::create.
  static Result<std::unique_ptr<Run>> create(std::shared_ptr<const mission::Program> program,
                                             const mission::Runners& runners, std::vector<type::Value> inputs,
                                             RunOptions options = {});
  ~Run();

  /// Blocks until the mission has ended.
  const mission::MissionResult& run();
  /// Preempts everything that runs; nothing new starts. From any thread, as the next three.
  void stop();
  /// No action begins any more; running ones continue. May be called before run().
  void pause();
  /// Ends a pause.
  void resume();
  /// Begins one more action, or opaque subtree, during a pause: the first that can.
  void step();

  /// The result of the network and its order, after the run.
  [[nodiscard]] const task_network::RunResult& network_result() const;
  [[nodiscard]] const task_network::Order& order() const;
  [[nodiscard]] const MissionPlan& plan() const;
  [[nodiscard]] mission::Globals& globals();

 private:
  class Implementation;
  explicit Run(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

/// Plans about `most` nodes, or as many as are known before anything runs. With `assumed` it continues from
/// there in virtual time, as if actions ended as these runners say. Blocks; the plan cannot be run
/// afterwards. Returns the error of the mission if that ends it early; NotFound if an action has no runner.
Result<std::optional<Error>> plan_ahead(MissionPlan& plan, std::size_t most,
                                        const mission::Runners* assumed = nullptr);

}  // namespace segue::convert

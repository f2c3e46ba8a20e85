// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/mission/action_runner.hpp>
#include <segue/mission/commanded_robot.hpp>
#include <segue/type/value.hpp>

#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

/// Looks at a robot, for conditions that end actions and for facts that are observed.
namespace segue::mission {

/// Samples of one port from when it was opened. One thread at a time.
struct PortFeed {
  Member port;
  std::unique_ptr<PortSamples> samples;
  std::vector<type::Value> fresh{};  ///< what came between the last two polls, oldest first
  std::optional<type::Value> last{};

  static Result<PortFeed> open(CommandedRobot& robot, const Member& port, const Wait& wait);
  /// Takes in what has come. Does not wait for samples.
  Result<void> poll(const Wait& wait);
  /// Takes in the samples that have come, or else the next ones; nothing at the deadline. Blocks.
  Result<void> next(const Wait& wait);

 private:
  Result<void> take_in(Result<std::vector<type::Value>> came);
};

/// Opens the ports that have no feed yet. `feeds` has one for each of `sources` then.
Result<void> open_feeds(CommandedRobot& robot, const std::vector<OutputSource>& sources,
                        std::vector<std::optional<PortFeed>>& feeds, const Wait& wait);

/// The condition as a sentence which says that it holds.
[[nodiscard]] std::string sentence(const EndCondition& condition);
/// Whether a task that was asked, or its process, may be gone.
[[nodiscard]] bool may_be_lost(const Error& error);
[[nodiscard]] bool is_in(const TaskView& task, const TaskReaches& state);
/// Blocks until the operation has answered.
[[nodiscard]] Result<bool> holds(CommandedRobot& robot, const OperationAnswers& when, const Wait& wait);

/// How an action ends whose controller is in this trouble; nothing where it is in none. `awaits`: whether the
/// action waits for that task to fail; empty: it waits for none.
[[nodiscard]] std::optional<Ending> ending_by(const ControllerTrouble& trouble, const std::string& controller,
                                              const std::function<bool(const std::string& task)>& awaits);
/// Waits until the next poll; returns earlier where a stop is requested.
void wait_for_next_poll(Duration period, const std::stop_token& stop);

}  // namespace segue::mission

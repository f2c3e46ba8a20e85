// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/error.hpp>
#include <segue/task_network/node_status.hpp>
#include <segue/task_network/run_summary.hpp>
#include <segue/type/value.hpp>

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace segue::draw {
struct Gantt;
}  // namespace segue::draw

namespace segue::mission_run {

/// How a run ended.
struct RunOverview {
  std::string name;            ///< of the plan
  std::string outcome;         ///< the mission's own, "aborted" or "preempted"; "done", "failed" or "stopped"
  bool succeeded = false;      ///< neither failed nor stopped early
  std::optional<Error> error;  ///< why it failed
  type::ValueMap outputs;      ///< of a mission
  Duration makespan{};         ///< from its begin to its end, on its own clock
  std::size_t actions = 0;     ///< executions of actions, or nodes, but for those that were off the path
};

/// An execution of an action, or a node of the task network, as a table shows it. Times are since the run
/// began.
struct RunRow {
  std::string name;
  bool started = false;  ///< else the times mean nothing
  Duration start{};
  Duration end{};
  task_network::NodeStatus status = task_network::NodeStatus::NotReached;
  std::string outcome;     ///< as written: of the action; empty where it has not ended
  std::string waited_for;  ///< concurrently: the last thing that it waited for
};

/// A run that has ended, and all that lists, files and drawings show of it. One thread at a time.
class FinishedRun {
 public:
  FinishedRun();
  virtual ~FinishedRun();
  FinishedRun(const FinishedRun&) = delete;
  FinishedRun& operator=(const FinishedRun&) = delete;

  [[nodiscard]] const RunOverview& overview() const { return overview_; }
  /// True: in the order in which actions began, one after another only where the plan says so. False: nodes
  /// in program order, of which some were not on the path taken (`Skipped` and not `started`).
  [[nodiscard]] virtual bool as_written() const = 0;
  /// The first `most` rows.
  [[nodiscard]] virtual std::vector<RunRow> rows(
      std::size_t most = std::numeric_limits<std::size_t>::max()) const = 0;
  /// For draw::to_svg, to_html and to_trace. Made when it is first asked for, which is linear in the run.
  [[nodiscard]] const draw::Gantt& gantt();
  /// The times of the sequential run and of the critical path, to compare the makespan with.
  [[nodiscard]] virtual const task_network::RunSummary& comparison() = 0;
  /// Why a concurrent run of a mission did not do more at the same time (convert::why_in_sequence).
  [[nodiscard]] virtual std::vector<std::string> why_in_sequence() const { return {}; }
  /// All of it, as `segue mission run --format json` prints it.
  [[nodiscard]] virtual type::Value to_value() = 0;

 protected:
  [[nodiscard]] virtual draw::Gantt make_gantt() const = 0;
  RunOverview overview_;

 private:
  std::unique_ptr<const draw::Gantt> gantt_;
};

}  // namespace segue::mission_run

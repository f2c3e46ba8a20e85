// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/base/result.hpp>
#include <segue/convert/ahead_of_failures.hpp>
#include <segue/draw/diagram.hpp>
#include <segue/mission/program.hpp>
#include <segue/mission_engine/run_journal.hpp>
#include <segue/mission_engine/runners.hpp>
#include <segue/mission_run/finished_run.hpp>
#include <segue/mission_run/run_control.hpp>
#include <segue/mission_script/script_robot.hpp>
#include <segue/task_network/completion_queue.hpp>
#include <segue/task_network/flat_file.hpp>
#include <segue/task_network/order.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

/// A mission or a task network, from its file to its run and its drawings: what `segue mission` does, for any
/// program.
namespace segue::mission_run {

/// Sequential: a mission as it is written, with the reference semantics; the nodes of a task network one
/// after another. Concurrent: as a task network, with the outcome of the sequential run.
enum class RunMode : std::uint8_t { Sequential, Concurrent };

/// A file that keeps what a run has done, so that a later one can continue it (mission::RunJournal).
struct JournalRequest {
  std::filesystem::path file;
  bool resume = false;  ///< continue the run in the file; otherwise the file must not exist
  /// With `resume`: what becomes of actions that had begun and not ended.
  mission::RunJournal::UnderWay under_way = mission::RunJournal::UnderWay::Refuse;
};

struct RunRequest {
  RunMode mode = RunMode::Sequential;
  task_network::ClockKind clock = task_network::ClockKind::Real;

  // Missions only; given for a task network they are refused.
  type::ValueMap inputs;             ///< in place of their defaults
  std::vector<std::string> facts;    ///< "p(a)" holds at the beginning, "!p(a)" does not
  mission::AttachedData world_data;  ///< what actions find attached to the world that they read
  std::string start_at;              ///< "fetch/grasp"; sequential only
  std::optional<JournalRequest> journal;

  // Who executes the actions of a mission.
  mission::Runners runners;                            ///< callbacks in C++
  std::string python = "python3";                      ///< executes scripts; empty: as `runners` says
  std::shared_ptr<mission::ScriptRobot> script_robot;  ///< `self.robot` in scripts; null: there is none
  bool simulate = false;                               ///< simulate every action by what is expected of it

  std::uint64_t seed = 0;  ///< varies simulated durations, the same way for the same number; 0: as expected
  mission::UnitCounts resources;   ///< how many units there are of some, in place of what the plan declares
  bool strict = false;             ///< concurrent: every node is strict, whatever the plan declares
  std::uint32_t workers = 0;       ///< concurrent: how many nodes run at the same time; 0: any number
  std::uint32_t world_copies = 0;  ///< concurrent: projected worlds at the same time; 0: any number
  task_network::OrderRule order = task_network::OrderRule::Epoch;  ///< of a task network only

  /// Steers the run of a mission; must outlive it. Null: it cannot be paused.
  RunControl* control = nullptr;
  /// Before these states a mission that runs sequentially is held, until `control` lets it go on.
  std::vector<std::string> breakpoints;
  /// It is held before these states, and what may run beside goes on; called on the thread of run(), each
  /// time.
  std::function<void(const std::vector<std::string>& paths)> on_held;
  bool steps_back = false;  ///< keeps what is needed to step back; sequential only, not with a journal
  /// Receives warnings, which are not failures. Called on the thread of run(), or on that of an opaque
  /// subtree.
  std::function<void(const std::string&)> note;
  /// Progress: of a mission see convert::RunOptions::observe. Of a task network: every run of a node that
  /// begins and that ends, on the thread of run(); `preempted` where it was cancelled.
  mission::StateObserver on_event;
};

struct ConvertRequest {
  type::ValueMap inputs;           ///< missions only, as the next
  std::vector<std::string> facts;  ///< as in RunRequest
  std::size_t horizon = 1000;      ///< how many nodes of a mission are planned
  bool strict = false;             ///< as in RunRequest
  bool assume_expected = false;    ///< where it must be decided to go on: go on as expected
  task_network::OrderRule order = task_network::OrderRule::Epoch;  ///< of a task network
  std::function<void(const std::string&)> note;  ///< such as that the mission is expected to fail
  /// Nodes of a task network in the diagram, at most.
  std::size_t most = std::numeric_limits<std::size_t>::max();
};

/// One plan, loaded and compiled. Immutable: any number of threads may use it, and run it, at the same time.
/// Copies share what is loaded.
class Session {
 public:
  /// Reads a mission file, the folder of a RAFCON machine, or a task network (JSON with `nodes`), validates
  /// it, and compiles it. `libraries`: folders in which libraries are looked for; for RAFCON's machines
  /// NAME=FOLDER. Every problem becomes a diagnostic with its place; nothing is returned where there are
  /// errors. Blocks while it reads.
  /// `conflicts`: of the robot that a mission commands (mission::claim_controllers).
  static std::optional<Session> load(const std::filesystem::path& file,
                                     const std::vector<std::string>& libraries, Diagnostics& diagnostics,
                                     const mission::ControllerConflicts* conflicts = nullptr);
  /// A mission that the program has made. InvalidArgument with the first problem.
  static Result<Session> create(mission::Mission mission,
                                const mission::ControllerConflicts* conflicts = nullptr);
  static Session create(task_network::FlatNetwork network);

  [[nodiscard]] bool is_network() const { return network_ != nullptr; }
  [[nodiscard]] const std::string& name() const;
  /// Null for a task network.
  [[nodiscard]] const mission::Program* program() const { return program_.get(); }

  /// The task network as it would run concurrently, and why each node comes after others. NotFound and
  /// TypeMismatch for inputs, ParseError for facts, Unsupported where a task network is given either. Blocks
  /// while it plans; nothing is executed.
  [[nodiscard]] Result<draw::Diagram> convert(const ConvertRequest& request) const;

  /// What may happen in a concurrent run although something earlier fails, which a sequential run would not
  /// do. Nothing if strict. Errors as of convert().
  [[nodiscard]] Result<convert::AheadOfFailures> ahead_of_failures(const ConvertRequest& request = {}) const;

  /// Runs the plan to its end, on this thread; blocks. That an action or the mission fails is not an error
  /// here but in the overview. `stop`, requested on any thread, preempts what is under way and ends the run
  /// soon; what the mission does to handle preemption still runs. Errors come before anything has been
  /// executed: those of convert(), NotFound where an action has no runner, those of the journal, and
  /// Unsupported where the mode or the kind of plan does not have what is requested.
  [[nodiscard]] Result<std::unique_ptr<FinishedRun>> run(const RunRequest& request,
                                                         const std::stop_token& stop = {}) const;

 private:
  Session() = default;

  std::shared_ptr<const mission::Program> program_;  ///< one of both is set
  std::shared_ptr<const task_network::FlatNetwork> network_;
};

}  // namespace segue::mission_run

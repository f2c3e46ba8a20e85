// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/base/result.hpp>
#include <segue/mission_run/finished_run.hpp>
#include <segue/mission_run/run_request.hpp>

#include <cstddef>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

namespace segue::convert {
struct AheadOfFailures;
}  // namespace segue::convert
namespace segue::draw {
struct Diagram;
}  // namespace segue::draw
namespace segue::mission {
struct ControllerConflicts;
struct Mission;
class Program;
}  // namespace segue::mission
namespace segue::task_network {
struct FlatNetwork;
}  // namespace segue::task_network

/// A mission or a task network, from its file to its run and its drawings: what `segue mission` does, for any
/// program. What only some programs need has headers of its own: run_control.hpp, draw/gantt.hpp,
/// draw/diagram.hpp, convert/ahead_of_failures.hpp, mission/program.hpp.
namespace segue::mission_run {

/// Folders of libraries, and the robot for which a plan is checked.
struct LoadOptions {
  /// Folders in which libraries are looked for; for RAFCON's machines NAME=FOLDER.
  std::vector<std::string> libraries{};
  /// Of the robot that a mission commands (mission::claim_controllers); null: of none.
  const mission::ControllerConflicts* conflicts = nullptr;
};

/// How a plan is shown as a task network.
struct ConvertRequest {
  type::ValueMap inputs{};           ///< missions only, as the next
  std::vector<std::string> facts{};  ///< as in RunRequest
  std::size_t horizon = 1000;        ///< how many nodes of a mission are planned
  bool strict = false;               ///< as in Concurrent
  bool assume_expected = false;      ///< where it must be decided to go on: go on as expected
  task_network::OrderRule order = task_network::OrderRule::Epoch;  ///< of a task network
  std::function<void(const std::string&)> note{};  ///< such as that the mission is expected to fail
  /// Nodes of a task network in the diagram, at most.
  std::size_t most = std::numeric_limits<std::size_t>::max();
};

/// One mission or task network, loaded and compiled. Immutable: any number of threads may use it, and run it,
/// at the same time. Copies share what is loaded.
class LoadedMission {
 public:
  /// Reads a mission file, the folder of a RAFCON machine, or a task network (JSON with `nodes`), validates
  /// it, and compiles it. Blocks while it reads. InvalidArgument; the error carries every problem with its
  /// place (diagnostics_of).
  [[nodiscard]] static Result<LoadedMission> load(const std::filesystem::path& file,
                                                  const LoadOptions& options = {});
  /// A mission that the program has made. InvalidArgument with the first problem. `conflicts` as in
  /// LoadOptions.
  [[nodiscard]] static Result<LoadedMission> create(mission::Mission mission,
                                                    const mission::ControllerConflicts* conflicts = nullptr);
  [[nodiscard]] static LoadedMission create(task_network::FlatNetwork network);

  [[nodiscard]] bool is_network() const { return network_ != nullptr; }
  [[nodiscard]] const std::string& name() const;
  /// Null for a task network.
  [[nodiscard]] const mission::Program* program() const { return program_.get(); }
  /// The findings of load() that are no errors.
  [[nodiscard]] const Diagnostics& warnings() const { return warnings_; }

  /// The task network as it would run concurrently, and why each node comes after others. NotFound and
  /// TypeMismatch for inputs, ParseError for facts, Unsupported where a task network is given either. Blocks
  /// while it plans; nothing is executed.
  [[nodiscard]] Result<draw::Diagram> convert(const ConvertRequest& request) const;

  /// The actions that may happen in a concurrent run although something earlier fails, which a sequential run
  /// would not execute. Nothing if strict. Errors as of convert().
  [[nodiscard]] Result<convert::AheadOfFailures> ahead_of_failures(const ConvertRequest& request = {}) const;

  /// Runs the plan to its end, on this thread; blocks. That an action or the mission fails is not an error
  /// here but in the overview. `stop`, requested on any thread, preempts what is under way and ends the run
  /// soon; what the mission does to handle preemption still runs. Errors come before anything has been
  /// executed: those of convert(), NotFound where an action has no runner, those of the journal,
  /// InvalidArgument for a number that must not be 0, and Unsupported where a mission is given what is for
  /// task networks, or the other way round.
  [[nodiscard]] Result<std::unique_ptr<FinishedRun>> run(const RunRequest& request,
                                                         const std::stop_token& stop = {}) const;

 private:
  LoadedMission() = default;

  std::shared_ptr<const mission::Program> program_;  ///< one of both is set
  std::shared_ptr<const task_network::FlatNetwork> network_;
  Diagnostics warnings_;
};

}  // namespace segue::mission_run

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/mission/action_runner.hpp>

#include <sys/types.h>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace segue::mission {

class ScriptRobot;

struct ScriptOptions {
  /// The interpreter, version 3.8 or newer: a path, or a name to be found in PATH.
  std::string python = "python3";
  /// The worker script; empty: the one installed with Segue.
  std::filesystem::path worker;
  /// An execution with larger inputs or outputs (in bytes of JSON) aborts.
  std::size_t largest_message = std::size_t{64} << 20U;
  /// How long a preempted script may take to end, in real time. Shorter than the engine's grace, so that the
  /// script is gone before the engine starts what follows it.
  Duration preemption_grace = std::chrono::seconds(9);
  /// `self.robot` of actions that declare `controllers`; null: it raises that there is none.
  std::shared_ptr<ScriptRobot> robot{};
};

/// Executes Python scripts (docs/missions.md) in a child process, which is started with the first script;
/// those of an isolated action in one of its own. Concurrent scripts run there in threads. Their output and
/// logs go to segue::log, with the path of the state as the source.
///
/// If the process ends, the executions in it abort, and the next script starts another process. Once a script
/// has ignored its preemption beyond the grace, its process gets no further scripts, which start in a new
/// one, and it is killed as soon as only such scripts are left in it. Persistent variables live as long as
/// their process. Functions may be called from any thread; none blocks except the destructor.
class ScriptRunner final : public ActionRunner {
 public:
  explicit ScriptRunner(ScriptOptions options = {});
  /// Ends the process: within two seconds, or immediately if it still executes something. Blocks.
  ~ScriptRunner() override;
  ScriptRunner(const ScriptRunner&) = delete;
  ScriptRunner& operator=(const ScriptRunner&) = delete;

  /// NotFound without the interpreter or the worker script.
  [[nodiscard]] Result<void> check() const override;
  std::optional<Ending> start(ActionCall& call) override;

  /// Sets what scripts see, and can wait for, as `paused`. Must be called by whoever pauses the engine.
  void set_paused(bool paused);

  /// The process that executes scripts that are not isolated; nothing before the first script and after the
  /// end of the process.
  [[nodiscard]] std::optional<pid_t> process() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace segue::mission

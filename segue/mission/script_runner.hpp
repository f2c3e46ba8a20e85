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

struct ScriptOptions {
  /// The interpreter, 3.8 or newer: a path, or a name that is looked for in PATH.
  std::string python = "python3";
  /// What it executes; empty: the one that is installed with Segue.
  std::filesystem::path worker;
  /// Inputs or outputs beyond these bytes (as JSON) abort an execution.
  std::size_t largest_message = std::size_t{64} << 20U;
  /// How long a script may go on in real time after it was preempted. Shorter than the engine's, so that
  /// nothing follows it that still runs beside it.
  Duration preemption_grace = std::chrono::seconds(9);
};

/// Executes Python scripts (docs/missions.md) in a process of its own, which begins with the first script.
/// Scripts of several states run there side by side, in threads. What they print and log goes to segue::log,
/// the state's path as source.
///
/// Where that process ends, what it was executing aborts, and the next script begins another. A script that
/// ignores its preemption beyond the grace gets no company any more: others begin in a new process, and the
/// old one is killed as soon as only such scripts are left in it; until then it is the engine that gives such
/// a script up. Persistent variables last as long as their
/// process. All functions may be called from any thread, and none blocks but the destructor.
class ScriptRunner final : public ActionRunner {
 public:
  explicit ScriptRunner(ScriptOptions options = {});
  /// Ends the process, within two seconds; at once where it still executes something.
  ~ScriptRunner() override;
  ScriptRunner(const ScriptRunner&) = delete;
  ScriptRunner& operator=(const ScriptRunner&) = delete;

  std::optional<Ending> start(Call& call) override;

  /// What scripts see as `paused`, and wait for; whoever pauses an engine tells it.
  void set_paused(bool paused);

  /// The process that executes scripts; nothing before the first one, and after its end.
  [[nodiscard]] std::optional<pid_t> process() const;

 private:
  class Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace segue::mission

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/rpc/peer.hpp>
#include <segue/type/value.hpp>
#include <segue/web/command.hpp>
#include <segue/web/files_verbs.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace segue::web {

/// How a mission runs. Strict: concurrently, but nothing runs ahead of what may still fail.
enum class MissionMode : std::uint8_t { Sequential, Concurrent, Strict };
/// "sequential", "concurrent", "strict"
std::optional<MissionMode> mission_mode_named(std::string_view name);

/// A run of a mission that a page asks for.
struct MissionOrder {
  std::filesystem::path file;
  type::ValueMap inputs;  ///< in place of their defaults
  MissionMode mode = MissionMode::Sequential;
  bool simulate = false;    ///< without the robot, in virtual time
  bool steps_back = false;  ///< keeps what is needed to step back; of a sequential run
  std::string who;          ///< asks, for the robot's journal
};

/// Runs a mission on this computer. On the robot it answers null once the mission commands it, and why that
/// is refused; a simulation answers the document of its run (`segue mission run --format json`) once that has
/// ended. Called by any thread; blocks until `deadline` at most.
using RunMission = std::function<Result<type::Value>(const MissionOrder& order, TimePoint deadline)>;

/// Who asks for something, and what they may do.
struct PageUser {
  std::string who;
  control::Role role = control::Role::Observe;
};

/// Carries out the requests of pages to start missions: those among the files of the robot that `segue
/// mission check` has no errors for. Functions block and may be called from any thread.
class MissionStarts {
 public:
  MissionStarts(FileVerbs& files, RunMission run) : files_(files), run_(std::move(run)) {}

  /// path -> {"mission", "description", "inputs" (a list of {"name", "type", "default"}), "needs_robot"}: of
  /// a mission that can be started. InvalidArgument where it cannot, with its errors.
  Result<type::Value> form(const Command& command, const PageUser& user);
  /// path, inputs (texts in YAML by name; of an input of type text as they are; an input that is left out has
  /// its default), mode, simulate, steps_back -> {"problems" (by input: why it does not take its text)} where
  /// nothing was started; {"run"}: what RunMission answers.
  /// PermissionDenied for a mission with Python to who may not run that as the user of the studio
  /// (Verb::RunScripts).
  Result<type::Value> start(const Command& command, const PageUser& user);

 private:
  FileVerbs& files_;
  const RunMission run_;
};

}  // namespace segue::web

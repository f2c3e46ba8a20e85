// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/world_view.hpp>
#include <segue/mission_engine/runners.hpp>
#include <segue/mission_engine/under_way.hpp>
#include <segue/task_network/order_rule.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace segue::mission {
class ScriptRobot;
class UnitKeeper;
}  // namespace segue::mission

/// The options of a run of a mission or a task network (LoadedMission::run). Plain values.
namespace segue::mission_run {

class RunControl;

/// Lets others step a sequential run of a mission.
struct Stepping {
  /// Pauses and steps it. Must outlive the run.
  std::reference_wrapper<RunControl> control;
  std::vector<std::string> breakpoints{};  ///< it is held before these states until `control` lets it go on
  bool steps_back = false;  ///< keeps what is needed to step back; Unsupported together with a journal
  /// It is held before these states, and what may run beside goes on. Called on the thread of run(), each
  /// time.
  std::function<void(const std::vector<std::string>& paths)> on_held{};
};

/// A mission as it is written, with the reference semantics; the nodes of a task network one after another.
struct Sequential {
  // Missions only.
  std::optional<std::string> start_at{};  ///< "fetch/grasp"; nothing: at the mission's start
  std::optional<Stepping> stepping{};     ///< nothing: it cannot be paused
};

/// As a task network, with the outcome of the sequential run.
struct Concurrent {
  bool strict = false;                          ///< every node is strict, whatever the plan declares
  std::optional<std::uint32_t> workers{};       ///< how many nodes run at the same time; nothing: any number
  std::optional<std::uint32_t> world_copies{};  ///< projected worlds at the same time; nothing: any number
  std::optional<std::uint32_t> ahead{};  ///< actions that run ahead at the same time; nothing: any number
  /// An action whose result is less likely to count does not run ahead; between 0 and 1.
  double least_likelihood = 0;
  /// Pauses the run of a mission. Must outlive the run. Null: it cannot be paused.
  RunControl* control = nullptr;
};

using RunMode = std::variant<Sequential, Concurrent>;

/// By which clock a run goes. Real: that of the machine. Virtual: simulated actions take no time, since the
/// clock jumps to the end of the next one; what callbacks and scripts take does not count.
enum class RunClock : std::uint8_t { Real, Virtual };

/// A file that keeps what a run has done, so that a later one can continue it (mission::RunJournal).
struct Journal {
  std::filesystem::path file;
  /// Continues the run in the file, with this done about actions that had begun and not ended. Nothing: the
  /// run begins, and the file must not exist.
  std::optional<mission::UnderWay> resume{};
};

/// Who executes Python scripts.
struct Scripts {
  std::string python = "python3";                    ///< the interpreter
  std::shared_ptr<mission::ScriptRobot> robot = {};  ///< `self.robot` in scripts; null: there is none
};

/// How a plan is run.
struct RunRequest {
  RunMode mode{};
  RunClock clock = RunClock::Real;

  // Missions only; given for a task network they are refused.
  type::ValueMap inputs{};             ///< in place of their defaults
  std::vector<std::string> facts{};    ///< "p(a)" holds at the beginning, "!p(a)" does not
  mission::AttachedData world_data{};  ///< what actions find attached to the world that they read
  std::optional<Journal> journal{};

  // Who executes the actions of a mission.
  mission::Runners runners{};                  ///< callbacks in C++
  std::optional<Scripts> scripts = Scripts{};  ///< nothing: as `runners` says
  bool simulate = false;                       ///< simulate every action by what is expected of it

  /// Varies simulated durations, the same way for the same number, which is not 0; nothing: as expected.
  std::optional<std::uint64_t> seed{};
  /// How many units there are of a resource, in place of what the plan declares.
  std::map<std::string, std::uint32_t> resources{};
  /// The robot that keeps the counts of the mission's resources `of: robot`. Null: there is none; then it is
  /// InvalidArgument where neither the mission nor `resources` say how many units of them there are.
  std::shared_ptr<mission::UnitKeeper> units{};
  task_network::OrderRule order = task_network::OrderRule::Epoch;  ///< of a task network only

  /// Receives warnings, which are not failures. Called on the thread of run(), or on that of an opaque
  /// subtree.
  std::function<void(const std::string&)> note{};
  /// Progress: of a mission see convert::RunOptions::observe. Of a task network: every run of a node that
  /// begins and that ends, on the thread of run(); `preempted` where it was cancelled.
  mission::StateObserver on_event{};
};

}  // namespace segue::mission_run

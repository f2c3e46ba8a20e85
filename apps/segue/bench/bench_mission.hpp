// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

/// A mission on a robot, sequentially against concurrently: the experiments of Brunner et al.,
/// "Autonomous parallelization of resource-aware robotic task nodes", 2019, with any robot and mission.
namespace segue::cli {

/// Something that is varied.
struct MissionFactor {
  enum class Kind : std::uint8_t { Input, Property, PoolSize };
  Kind kind = Kind::Input;
  std::string name;  ///< "boxes", "rover.seed", "planner"
  std::vector<type::Value> values;
};

struct MissionExperiment {
  std::filesystem::path robot;
  std::filesystem::path mission;
  std::vector<std::string> libraries;  ///< of the mission
  type::ValueMap inputs;               ///< those that are not varied
  std::vector<MissionFactor> factors;  ///< measured in all combinations
  std::vector<std::string> seeds;      ///< inputs, or properties (with a dot): the number of the run
  std::string clock;                   ///< TASK.PORT: seconds in the robot's own time; empty: none
  std::uint64_t runs = 5;              ///< in each mode, for each combination
  std::vector<std::string> published;  ///< figures to show, by combination; "": none is known
  /// Sequential runs have so many instances of each pool that is varied, and are made once for all sizes; 0:
  /// as many as the concurrent ones.
  std::uint32_t sequential_pools = 0;
  bool any_pace = false;  ///< also where the robot's clock was slower than kLeastPace
};

/// The least real-time factor of a simulated robot: planners and robot would hinder each other below.
inline constexpr double kLeastPace = 0.95;

/// One value of each factor.
using MissionSetting = std::vector<type::Value>;
/// Those of the sequential runs with which concurrent ones are compared.
MissionSetting sequential_setting(const MissionExperiment& experiment, MissionSetting setting);
/// In the order in which they are measured: the last factor varies first.
std::vector<MissionSetting> settings_of(const MissionExperiment& experiment);

/// Times of a run, in seconds.
struct MissionTimes {
  double makespan = 0;
  /// The makespan of a concurrent run in virtual time with the same durations of actions, where deciding
  /// takes no time.
  double ideal = 0;
};

struct MissionRun {
  bool concurrent = false;
  std::uint64_t seed = 0;
  bool ended_well = false;  ///< neither aborted nor preempted
  std::string outcome;      ///< as the mission ended
  std::string error;        ///< why it did not end well
  MissionTimes wall;
  std::optional<MissionTimes> robot;  ///< by the robot's own clock
  double planning = 0;                ///< wall time in which calls of pools were under way
  double idle = 0;                    ///< wall time in which no action was under way: the engine was deciding
};

/// One combination.
struct MissionCell {
  MissionSetting setting;
  std::string published;  ///< empty: not known
  std::vector<MissionRun> runs;
};

/// Starts the robot afresh, runs the mission and stops the robot; blocks. A mission that fails is no error.
/// NotFound, InvalidArgument and others where robot or mission cannot be loaded or do not have the factors
/// that are varied.
Result<MissionRun> run_mission_afresh(const MissionExperiment& experiment, const MissionSetting& setting,
                                      bool concurrent, std::uint64_t seed, const std::stop_token& stop);

/// Tables with footnotes, for people; JSON; and NAME.csv with every run, NAME.svg with the makespans. Blocks
/// on files.
std::string mission_bench_text(const MissionExperiment& experiment, const std::vector<MissionCell>& cells);
type::Value mission_bench_value(const MissionExperiment& experiment, const std::vector<MissionCell>& cells);
Result<void> write_mission_bench_files(const std::filesystem::path& folder,
                                       const MissionExperiment& experiment,
                                       const std::vector<MissionCell>& cells);

}  // namespace segue::cli

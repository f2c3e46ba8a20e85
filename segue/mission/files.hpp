// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/mission/mission.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Reading, writing and validating mission files (docs/missions.md). Readers report every problem with file,
/// line and column. Pure but for the functions that say that they read files.
namespace segue::mission {

/// A mission file as it is; libraries in other files stay names. Nothing where there are errors.
std::optional<Mission> read_mission(std::string_view text, const std::string& file, Diagnostics& diagnostics);

/// The exact inverse of read_mission.
std::string write_mission(const Mission& mission);

/// Reads the library files that the mission names but does not hold, and theirs in turn: `NAME.yaml` in the
/// folder of the file that names it, then in `folders`. What cannot be found is left for validate() to
/// report. Actions of libraries get the library's name in front where another action has theirs.
void add_libraries(Mission& mission, const std::vector<std::filesystem::path>& folders,
                   Diagnostics& diagnostics);

/// Every problem of a mission whose libraries are added: names that mean nothing, outcomes that lead nowhere,
/// states that are never reached, types that do not match, inputs that nobody can have written, libraries
/// that use themselves, facts and resources that nobody can ever make true or create. Linear but for the
/// reachability of writers, which is looked for within one container.
Diagnostics validate(const Mission& mission);

/// Where the script of an action lies that names a file; relative to the file that declares the action.
std::filesystem::path script_file(const Mission& mission, const Action& action);

/// All three: reads the file and its libraries, and validates. Nothing where there are errors. Warns of
/// scripts that are not there.
std::optional<Mission> load_mission(const std::filesystem::path& file,
                                    const std::vector<std::filesystem::path>& library_folders,
                                    Diagnostics& diagnostics);

/// Whether a value may stand in a port of that type. Null always may.
bool accepts(std::string_view type, const type::Value& value);
/// Whether what leaves a port of type `from` may enter one of type `to`.
bool connects(std::string_view from, std::string_view to);

}  // namespace segue::mission

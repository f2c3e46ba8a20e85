// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/mission/mission.hpp>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Reading, writing and validating mission files (docs/missions.md). Readers report every problem with file,
/// line and column. Functions are pure unless they say that they read files.
namespace segue::mission {

/// Reads the text of a mission file; libraries in other files remain names. Nothing if there are errors.
std::optional<Mission> read_mission(std::string_view text, const std::string& file, Diagnostics& diagnostics);

/// The exact inverse of read_mission.
std::string write_mission(const Mission& mission);

/// Whether a file that a mission names may be looked at; null: any. A file that may not be looked at counts
/// as missing.
using MayUse = std::function<bool(const std::filesystem::path& file)>;

/// Reads the library files that the mission names but does not contain, and those that they name in turn:
/// `NAME.yaml` in the folder of the file that names it, then in `folders`. Missing libraries are left for
/// validate() to report. An action of a library whose name is taken gets the library's name as a prefix.
/// Blocks on files.
void add_libraries(Mission& mission, const std::vector<std::filesystem::path>& folders,
                   Diagnostics& diagnostics, const MayUse& may_use = {});

/// Finds every problem of a mission whose libraries have been added: unknown names, outcomes without a
/// transition, unreachable states, types that do not match, inputs that are read before they can have been
/// written, recursive libraries, facts and resources that no action can provide. Linear, except for the
/// search for writers within one container.
Diagnostics validate(const Mission& mission);

/// The path of an action's script file, which is relative to the file that declares the action.
std::filesystem::path script_file(const Mission& mission, const Action& action);
/// The path of a script's file that is named at `where`.
std::filesystem::path script_file(const Mission& mission, const Script& script, const SourcePlace& where);

/// Reads the file and its libraries and validates the mission. Nothing if there are errors. Warns of missing
/// scripts. Blocks on files.
std::optional<Mission> load_mission(const std::filesystem::path& file,
                                    const std::vector<std::filesystem::path>& library_folders,
                                    Diagnostics& diagnostics);

/// Reads and validates the text as if it were the content of `file`, with the file's libraries. Nothing if
/// there are errors. Blocks on files.
std::optional<Mission> load_mission_text(std::string_view text, const std::filesystem::path& file,
                                         const std::vector<std::filesystem::path>& library_folders,
                                         Diagnostics& diagnostics, const MayUse& may_use = {});

/// Whether a port of that type accepts the value. Null is always accepted.
bool accepts(std::string_view type, const type::Value& value);
/// Whether values of a port of type `from` may flow to a port of type `to`.
bool connects(std::string_view from, std::string_view to);

}  // namespace segue::mission

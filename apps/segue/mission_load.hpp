// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/mission/files.hpp>
#include <segue/mission/rafcon.hpp>

#include <optional>
#include <string>
#include <vector>

/// Missions as the command line names them.
namespace segue::cli {

/// RAFCON's library paths out of NAME=DIR, or DIR, whose own name is the path's.
std::vector<mission::RafconLibraryPath> rafcon_library_paths(const std::vector<std::string>& given);

/// A mission file, or the folder of a RAFCON machine, with its libraries; validated. Nothing where there are
/// errors.
std::optional<mission::Mission> load_mission(const std::filesystem::path& file,
                                             const std::vector<std::string>& libraries,
                                             Diagnostics& diagnostics);

}  // namespace segue::cli

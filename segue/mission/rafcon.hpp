// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/mission/mission.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// State machines of RAFCON (github.com/DLR-RM/RAFCON), in every version of its storage format from 0.7 on.
namespace segue::mission {

/// Where RAFCON finds the libraries whose path begins with `name` (an entry of its LIBRARY_PATHS).
struct RafconLibraryPath {
  std::string name;
  std::filesystem::path folder;
};

/// Out of NAME=FOLDER, or FOLDER, whose own name is the path's.
std::vector<RafconLibraryPath> rafcon_library_paths(const std::vector<std::string>& texts);

/// What a machine consists of with all its libraries in place, as RAFCON counts it.
struct RafconCounts {
  std::uint64_t states = 0;  ///< of every kind: a library state, and what it stands for
  std::uint64_t library_states = 0;
  std::uint64_t transitions = 0;
  std::uint64_t data_flows = 0;
  friend bool operator==(const RafconCounts&, const RafconCounts&) = default;
};

struct RafconImport {
  Mission mission;
  RafconCounts counts;
};

/// Reads the machine in `folder` (with its statemachine.json) and the libraries it uses. Ids are made from
/// names, which remain as titles; RAFCON's ids remain as what scripts know states by; scripts become Python
/// actions, semantic data notes. What RAFCON never looks at is left out: transitions of the states of a
/// barrier. Nothing where there are errors: unreadable files, missing libraries, references to what is not
/// there. The mission may still have problems that validate() finds. Reads files.
std::optional<RafconImport> import_rafcon(const std::filesystem::path& folder,
                                          const std::vector<RafconLibraryPath>& libraries,
                                          Diagnostics& diagnostics);

}  // namespace segue::mission

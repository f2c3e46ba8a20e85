// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/base/result.hpp>
#include <segue/mission/mission.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

/// State machines of RAFCON (github.com/DLR-RM/RAFCON), in every version of its storage format from 0.7 on.
namespace segue::mission {

/// The folder of the libraries whose path begins with `name` (an entry of RAFCON's LIBRARY_PATHS); without a
/// name, of those whose path begins with any.
struct RafconLibraryPath {
  std::string name;
  std::filesystem::path folder;
};

/// Parses NAME=FOLDER, or FOLDER, whose last element is then the name.
std::vector<RafconLibraryPath> rafcon_library_paths(const std::vector<std::string>& texts);

/// The size of a machine with all its libraries expanded, as RAFCON counts it.
struct RafconCounts {
  std::uint64_t states = 0;  ///< of every kind; library states as well as their content
  std::uint64_t library_states = 0;
  std::uint64_t transitions = 0;
  std::uint64_t data_flows = 0;
  friend bool operator==(const RafconCounts&, const RafconCounts&) = default;
};

/// A mission that was read from a RAFCON machine.
struct RafconImport {
  Mission mission;
  RafconCounts counts;
};

/// The text of a file; NotFound where there is none.
using ReadText = std::function<Result<std::string>(const std::filesystem::path&)>;

/// Reads the machine in `folder` (with its statemachine.json) and the libraries that it uses. Ids are derived
/// from names, which are kept as titles; RAFCON's ids are kept as script ids; scripts become Python actions,
/// semantic data become notes. Transitions of the states of a barrier, which RAFCON ignores, are left out.
/// Nothing if there are errors: unreadable files, missing libraries, dangling references. The mission may
/// still have problems that validate() finds. Blocks on files, which `read` reads (nothing:
/// read_input_file()).
std::optional<RafconImport> import_rafcon(const std::filesystem::path& folder,
                                          const std::vector<RafconLibraryPath>& libraries,
                                          Diagnostics& diagnostics, const ReadText& read = {});

}  // namespace segue::mission

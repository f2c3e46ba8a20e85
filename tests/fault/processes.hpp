// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <sys/types.h>

/// Information from /proc about the processes of a test.
namespace segue::testing {

/// The living processes whose XDG_RUNTIME_DIR is `runtime_folder`: program names by pid.
std::map<pid_t, std::string> processes_of(const std::filesystem::path& runtime_folder);

/// Its deployment processes: pid by process name.
std::map<std::string, pid_t> deployments_of(const std::filesystem::path& runtime_folder);

/// Resources of a process; none after its end.
struct Holdings {
  /// How many there are of each name, without those of pools, which grow with concurrent work.
  std::map<std::string, std::size_t> threads;
  std::size_t descriptors = 0;
  std::size_t memory_maps = 0;  ///< mappings of shared anonymous memory (memfd)
};
Holdings holdings_of(pid_t pid);
/// Whether there is more of anything than before. The first thread of its name is not more: many are started
/// when they are needed for the first time.
bool has_grown(const Holdings& before, const Holdings& now);
std::string to_string(const Holdings& holdings);

/// Its state as one letter ('R', 'S', 'T' stopped, 'Z' dead); 0 if it has ended.
char state_of(pid_t pid);

}  // namespace segue::testing

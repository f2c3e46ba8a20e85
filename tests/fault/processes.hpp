// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <sys/types.h>

/// What /proc tells about the processes of a test.
namespace segue::testing {

/// Of the processes whose XDG_RUNTIME_DIR is `runtime_folder`, those that live: name of the program by pid.
std::map<pid_t, std::string> processes_of(const std::filesystem::path& runtime_folder);

/// Its deployment processes: pid by process name.
std::map<std::string, pid_t> deployments_of(const std::filesystem::path& runtime_folder);

/// What a process holds. A process that is gone holds nothing.
struct Holdings {
  std::size_t threads = 0;  ///< those of pools aside, which grow with what there is to do at one time
  std::size_t descriptors = 0;
  std::size_t memory_maps = 0;  ///< of memory without a file that it shares (memfd)

  friend bool operator==(const Holdings&, const Holdings&) = default;
};
Holdings holdings_of(pid_t pid);
std::string to_string(const Holdings& holdings);

/// Its state as one letter ('R', 'S', 'T' stopped, 'Z' dead); 0 where it is gone.
char state_of(pid_t pid);

}  // namespace segue::testing

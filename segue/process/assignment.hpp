// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>
#include <segue/process/launch.hpp>

#include <array>
#include <cstddef>
#include <filesystem>

/// What a process server hands to the program segue-deployment.
namespace segue::process {

/// The launch, and what concerns the process only.
struct Assignment {
  Launch launch;
  std::filesystem::path socket;
  std::filesystem::path log;  ///< what its standard output and error are; empty: it is not to rotate them
  std::size_t log_size = std::size_t{10} << 20;  ///< bytes after which output starts a new file
  int log_files = 3;                             ///< older ones that are kept
};

/// The descriptors that the process inherits, besides standard input, output and error.
enum Inherited : int {
  kAssignment = 3,  ///< a file with the Assignment as JSON
  kListener = 4,    ///< its socket, listening
  kLock = 5,        ///< beside the socket; held as long as the process lives
  kFirstFree = 6
};

/// As JSON in a file without a name.
Result<Descriptor> write_assignment(const Assignment& assignment);
/// InvalidArgument where it is not what write_assignment() makes. Leaves the descriptor open.
Result<Assignment> read_assignment(int descriptor);

}  // namespace segue::process

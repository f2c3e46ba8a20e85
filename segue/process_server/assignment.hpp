// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>
#include <segue/process_server/launch.hpp>

#include <array>
#include <cstddef>
#include <filesystem>

/// The interface between a process server and the program segue-deployment that it starts: the arguments and
/// descriptors that the program inherits, and the exit statuses that it answers.
namespace segue::process_server {

/// The name of the program that a deployment process runs.
inline constexpr const char* kDeploymentProgram = "segue-deployment";

/// Everything that the program has to know to begin.
struct Assignment {
  Launch launch;
  std::filesystem::path socket;
  std::filesystem::path log;  ///< file behind its standard output and error; empty: it does not rotate them
  std::size_t log_size = std::size_t{10} << 20;  ///< in bytes; beyond it the output goes on in a new file
  int log_files = 3;                             ///< older files that are kept
};

/// The descriptors that the program inherits besides standard input, output and error.
enum Inherited : int {
  kAssignment = 3,     ///< an anonymous file with the Assignment as JSON
  kListener = 4,       ///< its Unix socket, which listens already
  kLock = 5,           ///< the locked file beside the socket; the lock ends with the process
  kOutputChanges = 6,  ///< tells when its log has grown (open_output_changes())
  kFirstFree = 7
};

/// How the program ends. The last line of its log gives the details.
enum DeploymentExit : int {
  kOrderly = 0,       ///< it was asked to end
  kWrongUse = 2,      ///< it was started by hand, or its assignment is invalid
  kNotPermitted = 3,  ///< the system does not permit its scheduler, processors or limits
  kNoLibrary = 4,     ///< a component library, a component model or the stand-in file cannot be loaded
  kNoMemory = 5,      ///< there is no shared memory, or no socket to serve
  kHanging = 6,       ///< it was asked to end, and did although a hook of a task had not returned
  kDefect = 70        ///< a defect of Segue
};

/// Writes the assignment as JSON into an anonymous file (memfd). Fails where the system has no memory or
/// descriptors left.
Result<Descriptor> write_assignment(const Assignment& assignment);
/// Reads what write_assignment() wrote and leaves the descriptor open. InvalidArgument where the content is
/// anything else.
Result<Assignment> read_assignment(int descriptor);

}  // namespace segue::process_server

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

/// Starts the program of deployment processes. Internal.
namespace segue::process_server::detail {

/// The descriptors that a new process inherits, under the numbers of Inherited; -1: it does not get that one.
/// Its standard input is /dev/null; all other descriptors are closed.
struct HandedOver {
  int output = -1;  ///< standard output and error; -1: /dev/null
  int assignment = -1;
  int listener = -1;
  int lock = -1;
  int output_changes = -1;
};

/// Starts `program` by ChildProcess with `environment` added to that of this process. Fails, and leaves no
/// process behind, where the program cannot be executed.
Result<pid_t> spawn(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                    const std::vector<std::pair<std::string, std::string>>& environment,
                    const HandedOver& files);

/// The program of deployment processes: `chosen` if it is not empty, else $SEGUE_DEPLOYMENT, else
/// `segue-deployment` beside this program, in the install prefix or in PATH. NotFound names the places that
/// were searched.
Result<std::filesystem::path> find_program(const std::filesystem::path& chosen);

}  // namespace segue::process_server::detail

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

/// Starting a program as a process of its own. Internal.
namespace segue::process::detail {

/// What a new process shall have, by the number that it will have there (Inherited). Standard input is
/// /dev/null; all other descriptors are closed.
struct HandedOver {
  int output = -1;  ///< its standard output and error; -1: /dev/null
  int assignment = -1;
  int listener = -1;
  int lock = -1;
};

/// As ChildProcess does it. `environment` is added to this process's. Fails, with no process left, where the
/// program cannot be executed.
Result<pid_t> spawn(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                    const std::vector<std::pair<std::string, std::string>>& environment,
                    const HandedOver& files);

/// The program that becomes a deployment process: `chosen` if it is not empty, else $SEGUE_DEPLOYMENT, else
/// `segue-deployment` beside this program, in the install prefix or in PATH. NotFound with where it was
/// looked for.
Result<std::filesystem::path> find_program(const std::filesystem::path& chosen);

}  // namespace segue::process::detail

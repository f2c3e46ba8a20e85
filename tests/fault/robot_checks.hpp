// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <string>

#include "sight.hpp"

/// What every test of a disturbed robot waits for and checks, however it runs the robot.
namespace segue::testing {

/// Whether it becomes true; waits long.
[[nodiscard]] bool eventually(const std::function<bool()>& condition);

/// The deployment process of that name, of the robot whose runtime folder that is; -1 where there is none.
[[nodiscard]] pid_t pid_of(const std::filesystem::path& runtime_folder, const std::string& deployment);

/// Waits until `look` sees new beats; then checks that nothing has ever been wrong.
void expect_undisturbed(const std::string& watcher, const std::function<Sight()>& look);

/// No process of a robot with that runtime folder is left (what is, is killed), nor any socket.
void expect_nothing_left(const std::filesystem::path& runtime_folder);

}  // namespace segue::testing

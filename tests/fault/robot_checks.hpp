// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <string>

#include "sight.hpp"

/// Waits and checks for all tests of disturbed robots.
namespace segue::testing {

/// The deployment process of that name, of the robot whose runtime folder that is; -1 if there is none.
[[nodiscard]] pid_t pid_of(const std::filesystem::path& runtime_folder, const std::string& deployment);

/// Waits until `sample` sees new beats, then checks that the chain was never disturbed.
void expect_undisturbed(const std::string& watcher, const std::function<Sight()>& sample);

/// Checks that no process of a robot with that runtime folder is left, nor any socket. Kills remaining ones.
void expect_nothing_left(const std::filesystem::path& runtime_folder);

}  // namespace segue::testing

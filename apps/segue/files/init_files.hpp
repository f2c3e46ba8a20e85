// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "../new_folder.hpp"

namespace segue::cli {

/// The robot file (with @ROBOT@ for its name), the controller and the mission that explain all keys of their
/// kind. A line that begins with '#' and no space is a key that may be set, with lines below it that are
/// indented further.
extern const std::string_view kRobotFile;
extern const std::string_view kControllerFile;
extern const std::string_view kMissionFile;

/// The files of `segue init`: a robot with four controllers that use demo components, a mission, a README,
/// and with `library` a component library that builds against the installed package.
std::vector<NewFile> init_files(const std::string& robot, bool library);

}  // namespace segue::cli

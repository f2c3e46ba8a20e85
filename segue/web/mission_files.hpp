// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/base/result.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/type/value.hpp>
#include <segue/web/files_folder.hpp>
#include <segue/web/robot_files.hpp>

#include <filesystem>
#include <string>

/// Requests of pages about missions as files. Functions block on files.
namespace segue::web {

/// Which files a mission of the robot may name: those in the robot's folder, by the rules of FileFolder.
mission::MayUse within(const FileFolder& folder, const std::filesystem::path& root);

/// The diagnostics of `segue mission check` for the file if it had this text, as far as it names files that
/// it may; problems of the libraries that it uses have no place.
Diagnostics check_mission(const std::filesystem::path& file, const std::string& text,
                          const mission::MayUse& may_use);

/// The missions that a mission at `path` can name as libraries, since they are in its folder or below:
/// a list of {"name", "path", "description", "inputs", "outputs" (each a list of {"name", "type",
/// "default"}), "outcomes"}. Those with errors are left out.
type::Value libraries_for(const FileFolder& folder, const RobotFiles& files, const std::string& path);

}  // namespace segue::web

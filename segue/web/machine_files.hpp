// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/base/result.hpp>
#include <segue/web/files_folder.hpp>
#include <segue/web/robot_files.hpp>

#include <filesystem>
#include <map>
#include <string>

/// State machines of RAFCON in the folder of a robot. All of their files are read through a FileFolder, by
/// its rules. Functions block on files.
namespace segue::web {

/// A machine of RAFCON as a mission.
struct ImportedMachine {
  std::string text;
  std::map<std::string, std::string>
      folders;        ///< of its states, by their paths in the mission; within its own
  Diagnostics notes;  ///< what could not be kept
};
/// Its libraries are found below any folder within the robot's. ResourceExhausted where the machine or the
/// mission is too large for pages.
Result<ImportedMachine> import_machine(const FileFolder& folder, const std::filesystem::path& root,
                                       const RobotFiles& files, const std::string& path);

/// A file of a machine as it would be.
struct ChangedFile {
  std::string path;  ///< within the robot's folder
  std::string text;
};
/// The errors of `segue mission check` that the machine does not have yet, and would have with that file.
Diagnostics errors_by_change(const FileFolder& folder, const std::filesystem::path& root,
                             const RobotFiles& files, const std::string& path, const ChangedFile& changed);

}  // namespace segue::web

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace segue::cli {

struct NewFile {
  std::string path;  ///< relative to the new folder
  std::string text;
};

/// The folder's name as an identifier, for the robot in it; "my_robot" where that makes none.
std::string robot_name_of(const std::filesystem::path& folder);
/// InvalidArgument where it is not one.
Result<void> check_robot_name(const std::string& name);

/// AlreadyExists where there is something else than an empty folder.
Result<void> check_new_folder(const std::filesystem::path& folder);
/// Makes it with these files.
Result<void> write_new_folder(const std::filesystem::path& folder, const std::vector<NewFile>& files);

}  // namespace segue::cli

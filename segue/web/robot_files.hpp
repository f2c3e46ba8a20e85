// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/model/robot.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Which files pages can name: those that belong to a robot. Functions block on files.
namespace segue::web {

/// Machine: the folder of a state machine of RAFCON, whose semantic data alone are written.
enum class RobotFileKind : std::uint8_t { Robot, Network, Mission, Machine };
std::string_view to_string(RobotFileKind kind);  ///< "robot", "network", "mission", "rafcon"

struct RobotFile {
  std::string path;  ///< within the robot's folder
  std::filesystem::path place;
  RobotFileKind kind = RobotFileKind::Robot;
  bool is_named = false;  ///< by the robot file
};

struct RobotFiles {
  std::vector<RobotFile> files;
  bool complete = true;  ///< else there are more than were looked at
};

/// More missions and machines are not listed, more files in YAML are not read to see whether they are
/// missions, and the search ends at so many entries of folders.
inline constexpr std::size_t kMostListedFiles = 500;
inline constexpr std::size_t kMostReadFiles = 2000;
inline constexpr std::size_t kMostSearchedEntries = 20'000;
inline constexpr int kDeepestSearch = 8;

/// Whatever can be read of a robot file: one with errors must be shown, too.
std::optional<model::Robot> robot_in(const std::filesystem::path& file);
/// The networks that a robot file names.
std::vector<std::filesystem::path> networks_of(const model::Robot& robot);

/// The robot file first, then the networks and missions that it names, then the other missions in its folder
/// and the folders in it, and the state machines of RAFCON there. Hidden files and symbolic links are left
/// out of what is searched.
RobotFiles files_of(const std::filesystem::path& robot_file);
/// Without a search. NotFound where the robot has no such file, whatever else is there.
Result<RobotFile> find_file(const std::filesystem::path& robot_file, const std::string& path);

/// Checks that a new file can have that path: InvalidArgument. Folders and the file are named by letters,
/// digits, '_', '-', '.' and ':', not beginning with '.', and the file ends in .yaml or .yml.
Result<void> check_new_path(const std::string& path);

}  // namespace segue::web

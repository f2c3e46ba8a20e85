// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/base/file_stamp.hpp>
#include <segue/base/result.hpp>
#include <segue/model/files.hpp>
#include <segue/model/robot.hpp>
#include <segue/runtime/controller_set.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace segue::runtime {

/// A robot file and the controllers and transitions that it names, as all these files were at one moment.
struct RobotFiles {
  model::Robot robot;
  ControllerSet controllers;
};

/// Reads a robot file and all controllers and transitions that it names; notes its component model files.
/// Problems of all files go to `diagnostics`. Nothing where the robot file has errors; where others have,
/// whatever could be read. A file that changes before the last one is read is an error (`file-changed`),
/// because the files would not be those of one moment. `read` reads one file (base/input_file.hpp unless a
/// test gives another). Blocks; from any thread.
std::optional<RobotFiles> read_robot_files(const std::filesystem::path& file, Diagnostics& diagnostics,
                                           const model::ReadFile& read = {});

/// How a file differs from what was loaded.
struct FileChange {
  enum class Kind { Changed, Added, Removed };
  std::filesystem::path path;
  Kind kind = Kind::Changed;
  friend bool operator==(const FileChange&, const FileChange&) = default;
};
std::string_view to_string(FileChange::Kind kind);

/// The files of a running robot. All functions may be called from any thread and block for the file system.
class ControllerFiles {
 public:
  /// `started` as they were read from the robot file `file` when the runtime was started.
  ControllerFiles(std::filesystem::path file, const RobotFiles& started);

  /// The absolute path of the robot file.
  [[nodiscard]] const std::filesystem::path& file() const { return absolute_; }

  /// The files as they are now, checked one by one and together (model::validate() of the robot). Nothing
  /// where there are errors. What a running robot cannot take (hosts, libraries, models, policies, pools and
  /// the limits of look-ahead of the robot file; component model files) is a warning, `needs-restart`;
  /// another name is an error.
  [[nodiscard]] std::optional<ControllerSet> read(Diagnostics& diagnostics) const;

  /// The files whose content is no longer that of `loaded`, those that are gone, and new ones that match the
  /// robot's patterns; by path. A file is read only where its stamp has changed.
  [[nodiscard]] std::vector<FileChange> changes(const std::vector<LoadedFile>& loaded) const;

 private:
  void check_robot(const model::Robot& now, Diagnostics& diagnostics) const;
  /// Puts the model files of the start in place of those of now, since they are the ones in use.
  void keep_models(std::vector<LoadedFile>& files, Diagnostics& diagnostics) const;

  const std::filesystem::path file_;
  const std::filesystem::path absolute_;
  const model::Robot robot_;
  std::vector<LoadedFile> models_;  ///< of the start
};

}  // namespace segue::runtime

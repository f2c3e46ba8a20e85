// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/model/component_model.hpp>
#include <segue/model/files.hpp>
#include <segue/model/robot.hpp>
#include <segue/type/value.hpp>
#include <segue/web/command.hpp>
#include <segue/web/files_folder.hpp>
#include <segue/web/robot_files.hpp>
#include <segue/web/robot_link.hpp>

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>

namespace segue::web {

/// The component models that a robot knows; problems go to the diagnostics. Called by any thread.
using ModelsOf = std::function<model::ComponentCatalog(const model::Robot& robot, Diagnostics& diagnostics)>;

/// Carries out the requests of pages about a robot's files: its robot file, the networks and missions that
/// this names, and the rest of its folder (RobotFiles), on the computer where the studio runs. Which robot
/// file it is the robot says, so it must have been reached once; files can be edited while it does not run.
/// Nothing but these files can be named (FileFolder). Functions block and may be called from any thread.
class FileVerbs {
 public:
  FileVerbs(RobotLink& link, ModelsOf models) : link_(link), models_of_(std::move(models)) {}

  /// {"folder", "complete", "files": [{"path", "kind" (RobotFileKind), "named" (by the robot file), "problem"
  /// (why it cannot be edited; "")}]}
  Result<type::Value> list(const Command& command);
  /// path -> {"path", "text", "version", "notes"}; of a machine of RAFCON the mission that it becomes, with
  /// notes on what could not be kept, and "folders" ({path of a state: its folder within the machine}).
  Result<type::Value> read(const Command& command);
  /// path, text -> {"problems": [{"severity", "code", "message", "line", "column"}]}: what `segue check`
  /// would find in that file if it had this text, with the other files as they are.
  Result<type::Value> check(const Command& command);
  /// path, text, version -> {"version"}; InvalidState where the file is of another version.
  Result<type::Value> save(const Command& command);
  /// A network or mission where no file is yet: path, text -> {"version"}. robot_text, robot_version: the
  /// text that the robot file gets with it. It must name the network, or nothing is changed: InvalidArgument.
  Result<type::Value> create(const Command& command);
  /// path, to, version; robot_text and robot_version as of create().
  Result<type::Value> rename(const Command& command);
  /// path, version; robot_text and robot_version as of create().
  Result<type::Value> remove(const Command& command);
  /// The semantic data of a state of a machine of RAFCON: path, state (its folder within the machine) ->
  /// {"data", "version" ("": there is no file yet)}.
  Result<type::Value> semantic_data(const Command& command);
  /// path, state, version, edits ([{"keys", "value" (none: the entry is removed)}]) -> {"problems"}: the
  /// errors that the machine would have by them and has not yet, as of check(). Refused as
  /// save_semantic_data().
  Result<type::Value> check_semantic_data(const Command& command);
  /// path, state, version, edits -> {"version"}; InvalidState where the file is of another version,
  /// InvalidArgument where the edits cannot be made or the machine would have errors by them.
  Result<type::Value> save_semantic_data(const Command& command);
  /// path -> {"libraries"}: of libraries_for().
  Result<type::Value> libraries(const Command& command);
  /// A file of the robot, and its folder.
  struct Found {
    RobotFile file;
    FileFolder folder;
    std::filesystem::path root;
  };
  /// NotFound where the robot has no such file.
  Result<Found> find(const std::string& path);
  /// {"components": {name: model}}, read anew.
  Result<type::Value> models(const Command& command);

 private:
  /// A file that is to go or to be called otherwise.
  struct Changed {
    std::filesystem::path robot;
    RobotFile file;
    std::string version;
    FileFolder folder;
  };
  struct SemanticData;
  Result<Changed> file_to_change(const Command& command);
  Result<SemanticData> semantic_data_of(const Command& command);
  /// The semantic data that the command names, and their text with its edits.
  Result<std::pair<SemanticData, std::string>> edited(const Command& command);
  Result<std::filesystem::path> robot_file();
  std::shared_ptr<const model::ComponentCatalog> catalog(const model::Robot& robot, bool anew,
                                                         Diagnostics& diagnostics);
  /// {"problems": [{"severity", "code", "message", "line", "column"}]}
  static type::Value to_problems(Diagnostics found);
  Diagnostics check_network(const model::Robot* robot, const std::string& file, const std::string& text,
                            const model::ReadFile& read);
  Diagnostics check_robot(const std::string& file, const std::string& text, const model::Robot* saved,
                          const FileFolder& folder);
  Diagnostics check_mission(const model::Robot* robot, const RobotFile& file, const std::string& text,
                            const mission::MayUse& may_use);

  RobotLink& link_;
  const ModelsOf models_of_;
  Mutex mutex_;  ///< protects the next two
  std::filesystem::path last_file_ SEGUE_GUARDED_BY(mutex_);
  std::shared_ptr<const model::ComponentCatalog> catalog_ SEGUE_GUARDED_BY(mutex_);
  Mutex saving_;
};

}  // namespace segue::web

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/base/result.hpp>
#include <segue/model/component.hpp>
#include <segue/model/robot.hpp>
#include <segue/type/value.hpp>
#include <segue/web/command.hpp>
#include <segue/web/robot_link.hpp>

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

namespace segue::web {

/// The component models that a robot knows; problems go to the diagnostics. Called by any thread.
using ModelsOf = std::function<model::ComponentCatalog(const model::Robot& robot, Diagnostics& diagnostics)>;

/// What pages ask of a robot's files: its robot file and the networks that this names, of the computer where
/// the studio runs. Which robot file it is the robot says, so it must have been reached once; files can be
/// edited while it does not run. Nothing but these files can be named (FileFolder). Functions block and may
/// be called from any thread.
class FileVerbs {
 public:
  FileVerbs(RobotLink& link, ModelsOf models) : link_(link), models_of_(std::move(models)) {}

  /// {"folder", "files": [{"path", "kind" ("robot", "network"), "problem" (why it cannot be edited; "")}]}
  Result<type::Value> list(const Command& command);
  /// path -> {"path", "text", "version"}
  Result<type::Value> read(const Command& command);
  /// path, text -> {"problems": [{"severity", "code", "message", "line", "column"}]}: what `segue check`
  /// would find in that file if it had this text, with the other files as they are.
  Result<type::Value> check(const Command& command);
  /// path, text, version -> {"version"}; InvalidState where the file is of another version.
  Result<type::Value> save(const Command& command);
  /// {"components": {name: model}}, read anew.
  Result<type::Value> models(const Command& command);

 private:
  Result<std::filesystem::path> robot_file();
  std::shared_ptr<const model::ComponentCatalog> catalog(const model::Robot& robot, bool anew,
                                                         Diagnostics& diagnostics);
  Diagnostics check_network(const model::Robot* robot, const std::string& file, const std::string& text);
  Diagnostics check_robot(const std::string& file, const std::string& text);

  RobotLink& link_;
  const ModelsOf models_of_;
  std::mutex mutex_;  ///< protects the next two
  std::filesystem::path last_file_;
  std::shared_ptr<const model::ComponentCatalog> catalog_;
  std::mutex saving_;
};

}  // namespace segue::web

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/base/log.hpp>
#include <segue/base/result.hpp>
#include <segue/model/component_model.hpp>
#include <segue/model/robot.hpp>
#include <segue/model/robot_changes.hpp>
#include <segue/runtime/controller_files.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/task_host/task_host.hpp>

#include <filesystem>
#include <memory>
#include <string_view>

namespace segue::runtime {

/// In which processes the tasks of a network's deployments run.
enum class TaskPlacement {
  InProcess,  ///< all in this process: deployments are names only
  Processes   ///< in processes of their own on this computer, as the network says
};

struct EmbeddedOptions {
  bool stand_in = false;        ///< a stand-in for every component that is not installed
  bool only_stand_ins = false;  ///< stand-ins for all components
  std::filesystem::path
      stand_ins{};  ///< file with their behaviour (task_host/stand_in.hpp); empty: the default
  TaskPlacement placement = TaskPlacement::InProcess;
  bool daemon = false;                   ///< processes are started by `segue host`, not by this process
  bool take_over = false;                ///< from another runtime that commands the robot on other hosts
  LogLevel log_level = LogLevel::Info;   ///< of deployment processes
  bool journal = false;                  ///< keep a journal (RuntimeOptions::journal)
  std::filesystem::path journal_file{};  ///< its file; empty: journal::default_path()
  /// Differences from the files. Properties are as in the files again once those are applied.
  model::RobotChanges changes{};
};

/// A robot in this process, with everything that its robot file names. Needs no daemon; starts other
/// processes only if EmbeddedOptions::placement says so.
///
///     auto robot = segue::runtime::EmbeddedRobot::open("robot.yaml");
///     if (!robot) { std::cerr << to_string(robot.error()) << '\n'; return 1; }
///     auto result = (*robot)->switch_to("explore");
///
/// With TaskPlacement::Processes, deployments of this robot that already run are adopted into the
/// belief. They outlive this object and this process; tasks of this process do not.
///
/// Functions may be called from any thread. The destructor ends this process's tasks at once, and waits for
/// those that hang; shut_down() stops and cleans up everything first.
class EmbeddedRobot {
 public:
  /// Loads the robot file, its component libraries, models and controllers. Puts the problems of all files
  /// into `diagnostics` and returns null if there are errors. Blocks.
  static std::unique_ptr<EmbeddedRobot> open(const std::filesystem::path& file, Diagnostics& diagnostics,
                                             const EmbeddedOptions& options = {});
  /// The same with all errors in one; warnings are logged.
  static Result<std::unique_ptr<EmbeddedRobot>> open(const std::filesystem::path& file,
                                                     const EmbeddedOptions& options = {});
  ~EmbeddedRobot();

  [[nodiscard]] const model::Robot& robot() const;
  [[nodiscard]] const model::ComponentCatalog& catalog() const;
  [[nodiscard]] task_host::TaskHost& host();
  [[nodiscard]] Runtime& runtime();

  /// Requests a controller and waits for the result. Blocks.
  SwitchResult switch_to(std::string_view controller, RequestOptions options = {});
  /// The robot's files, to see what has changed in them since they were loaded.
  [[nodiscard]] const ControllerFiles& files() const;
  /// Reads all files of the robot as they are now, and applies them (Runtime::apply()); a result with
  /// diagnostics where they have errors. Blocks.
  ApplyResult apply(RequestOptions options = {});
  /// Switches to the empty network, without process pools: stops and cleans up every task and ends every
  /// deployment process. After a failure it tries once more and then kills the processes; the result says
  /// what failed. Blocks.
  SwitchResult shut_down();

  /// Ends this process with `status` if one of its tasks hangs: the destructor would wait for it for ever.
  /// Nothing is destroyed but the runtime, so that its journal is complete. Call it last, after shut_down().
  void exit_if_hanging(int status);

 private:
  struct Implementation;
  explicit EmbeddedRobot(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace segue::runtime

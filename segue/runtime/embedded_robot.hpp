// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/base/log.hpp>
#include <segue/base/result.hpp>
#include <segue/host/task_host.hpp>
#include <segue/model/component.hpp>
#include <segue/model/robot.hpp>
#include <segue/runtime/runtime.hpp>

#include <filesystem>
#include <memory>
#include <string_view>

namespace segue::runtime {

/// Where tasks live that a network's deployments name.
enum class Placement {
  InProcess,  ///< in this process, as all others: deployments are names only
  Processes   ///< in processes of their own on this computer, as the network says
};

struct EmbeddedOptions {
  bool stand_in = false;              ///< a stand-in for every component that is not installed
  bool only_stand_ins = false;        ///< stand-ins for all components
  std::filesystem::path stand_ins{};  ///< how they behave (host/stand_in.hpp); empty: as they are
  Placement placement = Placement::InProcess;
  bool daemon = false;                   ///< processes are started by `segue host`, not by this process
  LogLevel log_level = LogLevel::Info;   ///< of deployment processes
  bool journal = false;                  ///< what happens is kept (RuntimeOptions::journal)
  std::filesystem::path journal_file{};  ///< there; empty: at journal::default_path()
};

/// A robot in this process: everything that its robot file names, ready to switch. No daemon, no network;
/// other processes only where they are asked for (EmbeddedOptions::placement).
///
///     auto robot = segue::runtime::EmbeddedRobot::open("robot.yaml");
///     if (!robot) { std::cerr << to_string(robot.error()) << '\n'; return 1; }
///     auto result = (*robot)->switch_to("explore");
///
/// With Placement::Processes, deployments of this robot that already run are taken over: the belief is what
/// they show. They outlive this object and this process; its own tasks do not.
///
/// Functions may be called from any thread. The destructor ends this process's tasks at once; shut_down()
/// ends all in order.
class EmbeddedRobot {
 public:
  /// Loads the robot file, its component libraries, models and controllers. All problems (of all files) are
  /// in `diagnostics`; nothing is returned where there are errors. Warnings do not hinder.
  static std::unique_ptr<EmbeddedRobot> open(const std::filesystem::path& file, Diagnostics& diagnostics,
                                             const EmbeddedOptions& options = {});
  /// The same with the first problem as the error; warnings are logged.
  static Result<std::unique_ptr<EmbeddedRobot>> open(const std::filesystem::path& file,
                                                     const EmbeddedOptions& options = {});
  ~EmbeddedRobot();

  [[nodiscard]] const model::Robot& robot() const;
  [[nodiscard]] const model::ComponentCatalog& catalog() const;
  [[nodiscard]] host::TaskHost& host();
  [[nodiscard]] Runtime& runtime();

  /// Requests a controller and waits for the outcome. Blocks.
  SwitchResult switch_to(std::string_view controller, RequestOptions options = {});
  /// Brings the robot to the empty network: every task stopped and cleaned up in order, every deployment
  /// process ended. What goes wrong is tried again once; after that the processes are ended whatever they do,
  /// and the answer says what went wrong. Blocks.
  SwitchResult shut_down();

 private:
  struct Implementation;
  explicit EmbeddedRobot(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace segue::runtime

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/diagnostic.hpp>
#include <segue/base/log.hpp>
#include <segue/base/result.hpp>
#include <segue/model/robot_changes.hpp>
#include <segue/runtime/request_options.hpp>
#include <segue/runtime/robot_port.hpp>
#include <segue/runtime/switch_result.hpp>
#include <segue/type/value.hpp>

#include <chrono>
#include <filesystem>
#include <memory>
#include <string_view>

namespace segue::model {
class ComponentCatalog;
struct Robot;
}  // namespace segue::model

namespace segue::runtime {

class ControllerFiles;
class Runtime;

/// In which processes the tasks of a network's deployments run.
enum class TaskPlacement {
  InProcess,  ///< all in this process: deployments are names only
  Processes   ///< in processes of their own on this computer, as the network says
};

/// How a program runs a robot.
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
///     auto result = robot->switch_to("explore");
///     if (!result.ok()) std::cerr << result.why() << '\n';
///
/// With TaskPlacement::Processes, deployments of this robot that already run are adopted into the
/// belief. They outlive this object and this process; tasks of this process do not.
///
/// A value that can be moved; one that was moved from can only be assigned to or destroyed. All other
/// functions may be called from any thread. The destructor ends this process's tasks at once, and waits for
/// those that hang; shut_down() stops and cleans up everything first.
class EmbeddedRobot {
 public:
  static constexpr Duration kTimeout = std::chrono::seconds(10);  ///< of calls that do not give one

  /// Loads the robot file, its component libraries, models and controllers. The error carries the problems of
  /// all files (diagnostics_of()). Blocks.
  static Result<EmbeddedRobot> open(const std::filesystem::path& file, const EmbeddedOptions& options = {});
  EmbeddedRobot(EmbeddedRobot&& other) noexcept;
  EmbeddedRobot& operator=(EmbeddedRobot&& other) noexcept;
  ~EmbeddedRobot();

  /// All findings in its files, which are no errors.
  [[nodiscard]] const Diagnostics& warnings() const;
  [[nodiscard]] const model::Robot& robot() const;
  [[nodiscard]] const model::ComponentCatalog& catalog() const;
  [[nodiscard]] task_host::TaskHost& host();
  [[nodiscard]] Runtime& runtime();

  /// The samples of an output port from now on: `robot.port<Pose>("odometry.pose").next(10s)`. Its task may
  /// begin to exist later, and this must outlive the result.
  template <class T = type::Value>
  [[nodiscard]] Port<T> port(std::string_view address) {
    return Port<T>(PortValues(host(), address));
  }
  /// Writes a sample to an input port, "driver.goal", and waits until the task has taken it. The errors are
  /// those of TaskHost::write(), here and below of the function of TaskHost of the same name.
  Result<void> write(std::string_view port, const type::Value& sample, Duration timeout = kTimeout);
  /// Sets a property, or a member of one: "wheels.limits.speed".
  Result<void> set(std::string_view property, const type::Value& value, Duration timeout = kTimeout);
  /// Calls an operation, "planner.set_goal", with a map of its arguments by name, and waits for its result.
  Result<type::Value> call(std::string_view operation, const type::Value& arguments = type::ValueMap{},
                           Duration timeout = kTimeout);

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

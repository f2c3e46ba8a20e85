// SPDX-License-Identifier: Apache-2.0
#include "../participant/node_task.hpp"
#include "exposed_robot.hpp"
#include "rosout.hpp"

#include <segue/base/descriptor.hpp>
#include <segue/base/error.hpp>
#include <segue/base/robot_name.hpp>
#include <segue/base/text.hpp>
#include <segue/control/server.hpp>
#include <segue/ros2/dds_names.hpp>
#include <segue/task/operation.hpp>
#include <segue/task/sub_state.hpp>

#include <sys/eventfd.h>

#include <cerrno>
#include <memory>
#include <utility>

namespace ros2 {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// Has the tasks of the robot that it belongs to seen by ROS 2's tools: as a client of the robot, which asks
/// it like the commands do. While the robot is not reached there are no nodes, and it is in error.
class Exposure final : public NodeTask {
 public:
  Exposure()
      : NodeTask({.doc = "Shows the robot's tasks to ROS 2 as nodes",
                  .activity = segue::fd_driven(),
                  .descriptors = {"changes"}}) {}

 protected:
  segue::Result<void> on_configure() override {
    auto settings = wanted();
    if (!settings) return settings.error();
    if (auto joined = join(); !joined) return joined;
    settings->own_task = id();
    settings->own_node = node_name();
    auto publishers = open_topics(*settings);
    if (!publishers) {
      leave();
      return publishers.error();
    }
    announce(std::move(*publishers), {});
    settings_ = std::move(*settings);
    return {};
  }

  segue::Result<void> on_start() override {
    changes_ = segue::Descriptor(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC));
    if (!changes_.valid()) return segue::system_error("cannot make an eventfd", errno);
    if (auto done = trigger_fd(changes_.get(), "changes"); !done) return done;
    const ExposureRules rules{*writable_, "ROS 2, by task " + id(),
                              [this](segue::LogLevel level, const std::string& text) { log(level, text); }};
    auto exposed = std::make_unique<ExposedRobot>(shared_participant(), settings_, rules,
                                                  [this] { ::eventfd_write(changes_.get(), 1); });
    const segue::Lock lock(mutex_);
    exposed_ = std::move(exposed);
    return {};
  }

  void on_update() override {
    const std::string trouble = look();
    if (!trouble.empty()) error(unreachable_, "no task is a node of ROS 2: " + trouble);
  }

  void on_error() override {
    if (look().empty()) recovered();
  }

  void on_stop() override {
    std::unique_ptr<ExposedRobot> ended;
    const segue::Lock lock(mutex_);
    ended.swap(exposed_);
  }

  void on_cleanup() override {
    withdraw();
    settings_ = {};
    leave();
  }

 private:
  segue::Result<ExposedRobotSettings> wanted() const {
    const std::string robot = robot_->empty() ? segue::robot_of_process() : *robot_;
    if (robot.empty()) {
      return segue::fail(segue::ErrorCode::InvalidArgument,
                         "it is not known which robot this task belongs to; set the property 'robot'");
    }
    ExposedRobotSettings settings;
    auto socket = segue::control::socket_path(robot);
    if (!socket) return socket.error();
    settings.socket = std::move(*socket);
    settings.tasks = *tasks_;
    settings.name_space = *name_space_;
    while (settings.name_space.ends_with('/'))
      settings.name_space.pop_back();
    if (!settings.name_space.empty() && !settings.name_space.starts_with('/'))
      settings.name_space.insert(0, "/");
    if (auto valid = segue::ros2::dds_topic_name(settings.name_space + "/node"); !valid) {
      return segue::fail(segue::ErrorCode::InvalidArgument,
                         "namespace: " + segue::quote(*name_space_) +
                             " is not valid: expected letters, digits and '_', with '/' between them");
    }
    return settings;
  }

  /// The topics that the nodes of all tasks share.
  segue::Result<std::vector<segue::ros2::Gid>> open_topics(ExposedRobotSettings& settings) const {
    constexpr std::uint32_t kEventDepth = 1000;  // rmw_qos_profile_parameter_events
    segue::ros2::Quality quality;
    quality.depth = kEventDepth;
    segue::ros2::InterfaceLibrary library;
    auto events = MessageWriter::make(shared_participant(), library, "/parameter_events",
                                      "rcl_interfaces/msg/ParameterEvent", quality);
    if (!events) return events.error();
    settings.parameter_events = std::move(*events);
    std::vector<segue::ros2::Gid> publishers = {settings.parameter_events->gid()};
    if (!*log_) return publishers;
    auto rosout = Rosout::make(shared_participant());
    if (!rosout) return rosout.error();
    settings.rosout = std::move(*rosout);
    publishers.push_back(settings.rosout->publisher());
    return publishers;
  }

  /// Why the robot is not reached now.
  std::string look() {
    eventfd_t rings = 0;
    ::eventfd_read(changes_.get(), &rings);
    const segue::Lock lock(mutex_);
    return exposed_->trouble();
  }

  ExposureStatistics statistics() const {
    const segue::Lock lock(mutex_);
    return exposed_ == nullptr ? ExposureStatistics() : exposed_->statistics();
  }

  Property<std::vector<std::string>> tasks_{
      *this,
      "tasks",
      {},
      {.doc = "the tasks that are nodes, by names or patterns such as arm_*; empty: all"}};
  Property<std::string> name_space_{*this, "namespace", {}, {.doc = "of their nodes: /robot; empty: none"}};
  Property<bool> writable_{
      *this,
      "writable",
      false,
      {.doc = "whether clients of ROS 2, which are not asked who they are, may set properties and call "
              "operations"}};
  Property<bool> log_{*this, "log", true, {.doc = "whether what the robot logs goes to /rosout"}};
  Property<std::string> robot_{
      *this, "robot", {}, {.doc = "name of the robot, which runs on this computer; empty: its own"}};
  Operation<ExposureStatistics()> statistics_{*this,
                                              "statistics",
                                              {},
                                              [this] { return statistics(); },
                                              RunsIn::CallerThread,
                                              "what clients of ROS 2 have asked so far"};
  ErrorState unreachable_{*this, "unreachable"};
  segue::Descriptor changes_;
  ExposedRobotSettings settings_;  ///< from configure to cleanup
  mutable segue::Mutex mutex_;
  std::unique_ptr<ExposedRobot> exposed_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace ros2

SEGUE_COMPONENT(ros2::Exposure)

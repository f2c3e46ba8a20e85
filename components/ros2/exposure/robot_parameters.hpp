// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../participant/message_writer.hpp"
#include "exposed_parameters.hpp"
#include "shown_nodes.hpp"

#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/control/robot_service.hpp>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

namespace ros2 {

/// Has what becomes of the properties of a robot's tasks on /parameter_events, in a thread of its own. The
/// robot is asked only while somebody reads the topic: for its events, and for the tasks whose properties may
/// be others after these. So each value is told once; of changes that follow each other faster than a task is
/// asked, the last one.
class RobotParameters {
 public:
  /// `nodes` is asked for in the thread.
  RobotParameters(std::shared_ptr<segue::control::RobotService> robot, std::shared_ptr<MessageWriter> topic,
                  std::function<ShownNodes()> nodes);
  ~RobotParameters();
  RobotParameters(const RobotParameters&) = delete;
  RobotParameters& operator=(const RobotParameters&) = delete;

  /// There may be other nodes now. Any thread.
  void look();

 private:
  /// A node, while somebody reads.
  struct Known {
    std::string node;
    std::uint64_t number = 0;
    bool is_new = false;  ///< it was not there before the reader
    bool has_to_be_asked = true;
    std::optional<std::vector<ExposedParameter>> told{};  ///< as readers know them
  };

  void run(const std::stop_token& stop);
  void follow(const std::stop_token& stop);
  void take_nodes(bool are_new);
  /// Asks the tasks that have to be asked; false: some have not answered.
  bool ask_tasks(const std::stop_token& stop);
  void tell(Known& known, const segue::type::Value& report) const;
  void take_events(const segue::type::Value& events);
  /// For a wait that look() ends; nothing where that has been called since the last one.
  std::optional<std::stop_token> next_wait();
  void pause(const std::stop_token& stop);

  const std::shared_ptr<segue::control::RobotService> robot_;
  const std::shared_ptr<MessageWriter> topic_;
  const std::function<ShownNodes()> nodes_;
  // By the thread alone:
  bool were_read_ = false;  ///< from before there were nodes
  std::uint64_t last_event_ = 0;
  std::map<std::string, Known> known_;  ///< by task
  segue::Mutex mutex_;
  segue::StoppableConditionVariable changed_;
  bool has_changed_ SEGUE_GUARDED_BY(mutex_) = false;
  std::stop_source wait_ SEGUE_GUARDED_BY(mutex_);
  std::jthread thread_;
};

}  // namespace ros2

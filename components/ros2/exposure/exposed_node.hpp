// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../participant/message_writer.hpp"
#include "../participant/participant.hpp"
#include "../services/service_executor.hpp"
#include "exposed_task.hpp"

#include <segue/base/life_cycle.hpp>
#include <segue/ros2/interface_library.hpp>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace ros2 {

/// A task of a robot as a node of ROS 2: parameters, the life cycle to be looked at, and operations.
class ExposedNode {
 public:
  /// `name`: "/robot/drive". Its services are answered by the executor, which must outlive it;
  /// `parameter_events` is a publisher that it shares with others. Fails where the name is not valid, or Fast
  /// DDS cannot make its endpoints.
  static segue::Result<std::unique_ptr<ExposedNode>> make(const std::shared_ptr<Participant>& participant,
                                                          ServiceExecutor& executor, const std::string& name,
                                                          std::shared_ptr<ExposedTask> task,
                                                          const segue::ros2::Gid& parameter_events);
  /// Others see it no longer.
  ~ExposedNode();
  ExposedNode(const ExposedNode&) = delete;
  ExposedNode& operator=(const ExposedNode&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  /// Notes the state, and tells others of the change. One thread at a time.
  void set_state(segue::TaskState state);

 private:
  using Answers = std::vector<std::pair<ServiceExecutor::Service, ServiceExecutor::Answer>>;

  ExposedNode(std::shared_ptr<Participant> participant, std::string name, std::shared_ptr<ExposedTask> task);
  segue::Result<void> open(ServiceExecutor& executor);
  void add(Answers& answers, const std::string& name, const std::string& interface,
           ServiceExecutor::Answer answer) const;
  void add_parameter_services(Answers& answers) const;
  void add_lifecycle_services(Answers& answers) const;
  void add_operations(Answers& answers) const;

  const std::shared_ptr<Participant> participant_;
  const std::string name_;
  const std::shared_ptr<ExposedTask> task_;
  segue::ros2::NodeEntities entities_;
  std::vector<std::shared_ptr<ServiceExecutor::Handle>> services_;
  std::unique_ptr<MessageWriter> events_;
};

}  // namespace ros2

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "node_task.hpp"
#include "parameter_client.hpp"
#include "started_node.hpp"
#include "types.hpp"

#include <segue/task/sub_state.hpp>

#include <chrono>
#include <memory>
#include <string>
#include <vector>

namespace ros2 {

/// A task that stands for a node of ROS 2, which runs already or which the task starts. While it runs it is
/// updated every second, and when the node's process ends.
class NodeProxy : public NodeTask {
 protected:
  explicit NodeProxy(std::string doc);

  /// Refuses wrong properties, and joins ROS 2. The error of join().
  segue::Result<void> join_checked();
  /// Until the destructor of what it returns, `ended` is called in another thread where the node's process
  /// ends.
  class Watch;
  /// Starts the node, with its parameters, where `process` says how. Fails as StartedNode::start().
  segue::Result<void> start_node(segue::TimePoint deadline);
  /// Ends it where it was started, and lets go of what belongs to it. What does not work is logged.
  void finish_node();
  /// After start_node(): sets the parameters of a node that was not started here, where there are any.
  segue::Result<void> set_parameters(segue::TimePoint deadline);
  /// In place of a failure that comes of it: how the node's process has ended.
  [[nodiscard]] segue::Error cause_of(segue::Error failure) const;

  /// In on_start: the timer, and the end of the node's process, trigger updates.
  segue::Result<void> trigger_looks();
  /// In on_update and on_error: whether to go on. Enters Exception where the node's process has ended.
  bool look();

  [[nodiscard]] bool starts_node() const { return !process_->is_empty(); }
  /// Empty while it runs, and where it was not started here.
  [[nodiscard]] std::string end_of_process() const { return started_ ? started_->end() : std::string(); }
  [[nodiscard]] StartedNode* started() { return started_.get(); }
  [[nodiscard]] const std::string& node() const { return *name_; }
  [[nodiscard]] segue::TimePoint deadline() const { return segue::Deadline(*timeout_); }
  /// Tells others that the endpoints of these requesters, and those for parameters, are those of this task.
  void announce_requesters(std::vector<const Requester*> requesters);

  segue::task::ErrorState unseen_{*this, "unseen"};

 private:
  segue::Result<void> make_parameter_client();
  segue::Result<void> request_parameters(const segue::type::Value& parameters, segue::TimePoint deadline);
  segue::Result<void> set_live(const segue::type::Value& parameters);

  segue::task::Property<std::string> name_{*this, "name", {}, {.doc = "name of the node: /robot/talker"}};
  segue::task::Property<ProcessSettings> process_{
      *this,
      "process",
      {},
      {.doc = "how the node is started: {package: .., executable: ..}; empty: it runs already"}};
  segue::task::DynamicProperty parameters_{
      *this,
      "parameters",
      "",
      segue::type::Value::map({}),
      {.live = true,
       .doc = "of the node: {rate: 10, pid: {gain: 0.5}}",
       .on_live_set = [this](const segue::type::Value& value) { return set_live(value); }}};
  segue::task::Property<std::chrono::nanoseconds> timeout_{
      *this, "timeout", std::chrono::seconds(10), {.doc = "the longest time for each change of its state"}};
  std::unique_ptr<StartedNode> started_;
  std::unique_ptr<ParameterClient> parameter_client_;
  std::vector<const Requester*> requesters_;  ///< of the node's services, beside those for parameters
  segue::Descriptor timer_;
};

/// Calls `ended` where the process of a started node ends while this lives.
class NodeProxy::Watch {
 public:
  Watch(StartedNode* node, std::function<void()> ended) : node_(node) {
    if (node_ != nullptr) node_->watch(std::move(ended));
  }
  ~Watch() {
    if (node_ != nullptr) node_->stop_watching();
  }
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

 private:
  StartedNode* node_;
};

}  // namespace ros2

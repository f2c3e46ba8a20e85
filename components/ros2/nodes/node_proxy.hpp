// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../participant/node_task.hpp"
#include "../participant/types.hpp"
#include "../topics/topic_ports.hpp"
#include "node_parameters.hpp"
#include "started_node.hpp"

#include <segue/task/sub_state.hpp>

#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace ros2 {

/// A task that stands for a node of ROS 2, which runs already or which the task starts. Topics of the node
/// are ports of the task. While it runs it is updated every second, when the node's process ends, and for
/// samples at its inputs.
class NodeProxy : public NodeTask {
 protected:
  explicit NodeProxy(std::string doc);

  /// Refuses wrong properties, joins ROS 2, and makes the ports. The error of join(); leave_all() undoes it.
  segue::Result<void> join_checked();
  void leave_all();
  /// Until the destructor of what it returns, `ended` is called in another thread where the node's process
  /// ends.
  class Watch;
  /// Starts the node, with its parameters, where `process` says how. Fails as StartedNode::start().
  segue::Result<void> start_node(segue::TimePoint deadline);
  /// Ends it where it was started, and lets go of what belongs to it. What does not work is logged.
  void finish_node();
  /// After start_node(): sets the parameters of a node that was not started here, where there are any.
  segue::Result<void> set_parameters(segue::TimePoint deadline);
  /// Gives parameters of a node that was not started here the values that they had before. What does not work
  /// is logged. For a node that answers, else it waits.
  void give_parameters_back();
  /// In place of a failure that comes of it: how the node's process has ended.
  [[nodiscard]] segue::Error cause_of(segue::Error failure) const;

  /// In on_start, before the node acts: from here on its samples go out; close_ports() ends that.
  void open_ports() { ports_.start(); }
  void close_ports() { ports_.stop(); }
  /// In on_start, when the node acts: waits until it is ready, where a property says when that is. Then the
  /// timer, and the end of the node's process, trigger updates.
  segue::Result<void> finish_start(segue::TimePoint deadline);
  /// In on_update and on_error: sends what the node subscribes to, and tells whether a second has passed.
  /// Enters Exception where the node's process has ended.
  bool look();
  /// Any thread: makes look() say that a second has passed.
  void look_now() const;

  [[nodiscard]] bool starts_node() const { return !process_->is_empty(); }
  /// Whether the node is seen; of one that was started here, not that of a process before, which is known for
  /// a while after its end.
  [[nodiscard]] bool sees_node() const;
  /// Empty while it runs, and where it was not started here.
  [[nodiscard]] std::string end_of_process() const { return started_ ? started_->end() : std::string(); }
  [[nodiscard]] StartedNode* started() { return started_.get(); }
  [[nodiscard]] const std::string& node() const { return *name_; }
  [[nodiscard]] segue::TimePoint deadline() const { return segue::Deadline(*timeout_); }
  /// Tells others that the endpoints of these requesters, those for parameters, and those of ports are those
  /// of this task.
  void announce_requesters(std::vector<const Requester*> requesters);

  segue::task::ErrorState unseen_{*this, "unseen"};

 private:
  static segue::Result<void> check_topics(const segue::type::Value& topics, std::string_view path);
  segue::Result<void> open_parameters();
  segue::Result<void> set_live(const segue::type::Value& parameters);
  [[nodiscard]] segue::Result<TopicPorts::Wanted> wanted_ports() const;
  segue::Result<void> trigger_looks();

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
  segue::task::DynamicProperty publishes_{
      *this,
      "publishes",
      "",
      segue::type::Value::map({}),
      {.doc = "topics of the node as outputs, by names of ports: {scan: sensor_msgs/msg/LaserScan}"},
      check_topics};
  segue::task::DynamicProperty subscribes_{
      *this,
      "subscribes",
      "",
      segue::type::Value::map({}),
      {.doc = "topics of the node as inputs: {cmd: {topic: /cmd_vel, type: geometry_msgs/msg/Twist}}"},
      check_topics};
  segue::task::Property<std::vector<std::string>> ready_{
      *this, "ready", {}, {.doc = "ports of publishes: start is complete when each has had a sample"}};
  segue::task::Operation<NodeStatistics()> statistics_{*this,
                                                       "statistics",
                                                       {},
                                                       [this] { return ports_.statistics(); },
                                                       segue::task::RunsIn::TaskThread,
                                                       "what has passed the ports so far"};
  segue::task::Operation<std::vector<std::string>()> mismatches_{
      *this,
      "mismatches",
      {},
      [this] { return ports_.mismatches(); },
      segue::task::RunsIn::TaskThread,
      "why no samples travel between ports and the node"};
  segue::task::Operation<std::vector<std::string>()> changed_parameters_{
      *this,
      "changed_parameters",
      {},
      [this] { return node_parameters_.changed(); },
      segue::task::RunsIn::TaskThread,
      "parameters that others have changed, of those that the controller has set"};
  TopicPorts ports_;
  std::unique_ptr<StartedNode> started_;
  NodeParameters node_parameters_;
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

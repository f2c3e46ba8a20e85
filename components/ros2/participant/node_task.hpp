// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "participant.hpp"

#include <segue/base/mutex.hpp>
#include <segue/ros2/interface_library.hpp>
#include <segue/task/component.hpp>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace ros2 {

/// The id of a task, such as "front.camera", as the name of a node.
std::string node_name_of(std::string_view task);

/// A task that is a node of ROS 2 for others.
class NodeTask : public segue::task::Component {
 protected:
  explicit NodeTask(const segue::task::ComponentOptions& options) : Component(options) {}

  /// Reads the properties and joins ROS 2, as a node named after the task, with `prefix` before its name,
  /// unless the property says otherwise. Enters Exception where Fast DDS cannot start.
  segue::Result<void> join(std::string_view prefix = {});
  /// Tells others which endpoints are those of this task.
  void announce(std::vector<segue::ros2::Gid> publishers, std::vector<segue::ros2::Gid> subscriptions);
  void withdraw();
  /// Undoes join(); the endpoints must have been deleted.
  void leave();

  /// "/robot/scan"; after join().
  [[nodiscard]] std::string node_name() const { return full_name(node_); }

  [[nodiscard]] segue::ros2::InterfaceLibrary library() const;
  /// In hooks, between join() and leave().
  Participant& participant() { return *participant_; }
  /// In any thread; nullptr outside of join() and leave().
  [[nodiscard]] std::shared_ptr<Participant> shared_participant() const;

 private:
  segue::Result<void> name_node(std::string_view prefix);

  segue::task::Property<std::vector<std::string>> interfaces_{
      *this, "interfaces", {}, {.doc = "folders with interface packages, before those that are built in"}};
  segue::task::Property<std::int32_t> domain_{
      *this, "domain", -1, {.doc = "domain of ROS 2, 0 to 232; -1: $ROS_DOMAIN_ID, or 0"}};
  segue::task::Property<std::string> discovery_{
      *this,
      "discovery",
      "",
      {.doc =
           "localhost, subnet or off; empty: as $ROS_AUTOMATIC_DISCOVERY_RANGE or $ROS_LOCALHOST_ONLY say, "
           "else subnet"}};
  segue::task::Property<std::vector<std::string>> static_peers_{
      *this,
      "static_peers",
      {},
      {.doc = "computers where nodes are looked for without multicast, by names or IPv4 addresses; none: "
              "those of $ROS_STATIC_PEERS"}};
  segue::task::Property<std::string> node_text_{
      *this, "node", {}, {.doc = "name of the node that others see: /robot/scan; empty: that of the task"}};

  segue::ros2::NodeEntities node_;
  std::shared_ptr<Participant> participant_;
  mutable segue::Mutex shared_mutex_;
  std::shared_ptr<Participant> shared_participant_ SEGUE_GUARDED_BY(shared_mutex_);
};

}  // namespace ros2

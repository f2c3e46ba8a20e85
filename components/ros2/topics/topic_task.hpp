// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../participant/node_task.hpp"
#include "../participant/types.hpp"
#include "topic_endpoint.hpp"

#include <segue/task/component.hpp>

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

/// Topics of ROS 2 as tasks: a Subscription has an output port, a Publisher an input port.
namespace ros2 {

/// The base of Publisher and Subscription, with the properties of their topic.
class TopicTask : public NodeTask {
 protected:
  /// `direction` of the one dynamic port, named `port`.
  TopicTask(segue::task::Direction direction, const std::string& port,
            const segue::task::ComponentOptions& options);

  /// Reads the properties, joins ROS 2, and makes a TopicReader or a TopicWriter, of which others are told.
  /// Enters Exception where Fast DDS cannot start.
  template <class Endpoint>
  segue::Result<std::unique_ptr<Endpoint>> open(TopicSettings settings, const std::string& port,
                                                const std::string& doc);
  [[nodiscard]] TopicSettings settings() const {
    return {*topic_, *type_, *reliability_, *durability_, *depth_, *deadline_, {}, *liveliness_, *lease_};
  }
  /// Undoes open().
  template <class Endpoint>
  void close(std::unique_ptr<Endpoint>& endpoint);
  [[nodiscard]] virtual const TopicEndpoint* endpoint() const = 0;

 private:
  std::vector<std::string> mismatches() const {
    return endpoint() == nullptr ? std::vector<std::string>() : endpoint()->mismatches();
  }

  segue::task::Property<std::string> topic_{*this, "topic", {}, {.doc = "name of the topic: /scan"}};
  segue::task::Property<std::string> type_{
      *this, "type", {}, {.doc = "its interface: sensor_msgs/msg/LaserScan"}};
  segue::task::Property<std::string> reliability_{
      *this, "reliability", "reliable", {.doc = "reliable or best_effort"}};
  segue::task::Property<std::string> durability_{
      *this, "durability", "volatile", {.doc = "volatile or transient_local"}};
  segue::task::Property<std::uint32_t> depth_{
      *this, "depth", 10, {.doc = "how many samples are kept; 0: all"}};
  segue::task::Property<std::chrono::nanoseconds> deadline_{
      *this, "deadline", {}, {.doc = "the longest time between two samples; 0: any"}};
  segue::task::Property<std::string> liveliness_{
      *this, "liveliness", "automatic", {.doc = "automatic or manual_by_topic"}};
  segue::task::Property<std::chrono::nanoseconds> lease_{
      *this, "lease", {}, {.doc = "the longest time without a sign of life; 0: any"}};
  segue::task::Operation<std::vector<std::string>()> mismatches_{
      *this,
      "mismatches",
      {},
      [this] { return mismatches(); },
      segue::task::RunsIn::TaskThread,
      "why no samples travel to or from others that have the topic"};
};

template <class Endpoint>
segue::Result<std::unique_ptr<Endpoint>> TopicTask::open(TopicSettings settings, const std::string& port,
                                                         const std::string& doc) {
  if (auto joined = join(); !joined) return joined.error();
  segue::ros2::InterfaceLibrary interfaces = library();
  auto made =
      Endpoint::make(shared_participant(), interfaces, settings, TopicPort{*this, id(), port, doc, {}});
  if (!made) {
    leave();
    return made.error();
  }
  if constexpr (Endpoint::kPublishes) {
    announce({(*made)->gid()}, {});
  } else {
    announce({}, {(*made)->gid()});
  }
  return std::move(*made);
}

template <class Endpoint>
void TopicTask::close(std::unique_ptr<Endpoint>& endpoint) {
  withdraw();
  endpoint.reset();
  leave();
}

}  // namespace ros2

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "node_task.hpp"
#include "types.hpp"

#include <segue/base/mutex.hpp>
#include <segue/ros2/message_codec.hpp>
#include <segue/task/component.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

/// Topics of ROS 2 as tasks: a Subscription has an output port, a Publisher an input port.
namespace ros2 {

/// The base of Publisher and Subscription.
class TopicEndpoint : public NodeTask {
 protected:
  /// `direction` of the one dynamic port, named `port`.
  TopicEndpoint(segue::task::Direction direction, const std::string& port,
                const segue::task::ComponentOptions& options);

  /// Reads the properties and joins ROS 2. Enters Exception where Fast DDS cannot start.
  segue::Result<void> open();
  /// Tells others of the endpoint, and watches for those that do not match.
  void watch(const segue::ros2::Gid& endpoint);
  void stop_watching();

  [[nodiscard]] const segue::ros2::MessageCodec& codec() const { return *codec_; }
  [[nodiscard]] const segue::ros2::Quality& quality() const { return own_.quality; }
  [[nodiscard]] TopicName topic_name() const { return {own_.topic, own_.type}; }
  /// Of the endpoint: the hash of its type.
  [[nodiscard]] std::string user_data() const { return "typehash=" + own_.type_hash + ";"; }
  void set_matched(std::int32_t count) { matched_ = static_cast<std::uint32_t>(std::max(count, 0)); }
  [[nodiscard]] std::uint32_t matched() const { return matched_; }
  /// Counts and logs that a deadline was missed or that liveliness was lost. In threads of Fast DDS.
  void missed(const std::string& what, std::uint32_t times);
  [[nodiscard]] std::uint64_t missed() const { return missed_; }
  /// How many endpoints of others have the topic but get nothing from this one, or the reverse.
  [[nodiscard]] std::uint32_t mismatched() const;

 private:
  segue::Result<segue::ros2::Quality> wanted_quality() const;
  std::vector<segue::ros2::Mismatch> mismatches() const;
  std::vector<std::string> mismatch_texts() const;
  /// Logs each mismatch that is new and has its name, up to a bound. In threads of Fast DDS.
  void check_others();

  segue::task::Property<std::string> topic_text_{*this, "topic", {}, {.doc = "name of the topic: /scan"}};
  segue::task::Property<std::string> type_text_{
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
      [this] { return mismatch_texts(); },
      segue::task::RunsIn::CallerThread,
      "why no samples travel to or from others that have the topic"};

  std::atomic<std::uint32_t> matched_{0};
  std::atomic<std::uint64_t> missed_{0};
  std::optional<segue::ros2::MessageCodec> codec_;
  segue::ros2::Endpoint own_;  ///< changed only while there is no endpoint
  mutable segue::Mutex others_mutex_;
  std::optional<segue::ros2::Endpoint> shown_ SEGUE_GUARDED_BY(others_mutex_);  ///< own_, for other threads
  std::set<std::string> said_ SEGUE_GUARDED_BY(others_mutex_);  ///< since nothing was there to be said
};

}  // namespace ros2

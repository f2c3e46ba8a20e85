// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../participant/participant.hpp"
#include "../participant/types.hpp"

#include <segue/base/mutex.hpp>
#include <segue/ros2/message_codec.hpp>
#include <segue/task/component.hpp>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace ros2 {

/// A port of a task that is a topic of ROS 2.
struct TopicPort {
  segue::task::Component& component;
  std::string task;  ///< its id, for log lines
  std::string name;
  std::string doc{};
  /// Of an output: the node whose samples it carries ("/robot/lidar"); empty: those of all.
  std::string node{};
};

/// The base of TopicReader and TopicWriter: a topic with its type and quality, and whose endpoints fit. Any
/// thread.
class TopicEndpoint {
 public:
  TopicEndpoint(const TopicEndpoint&) = delete;
  TopicEndpoint& operator=(const TopicEndpoint&) = delete;

  [[nodiscard]] const std::string& port() const { return port_.name; }
  /// "/scan"
  [[nodiscard]] std::string topic() const;
  /// Why no samples travel to or from others that have the topic.
  [[nodiscard]] std::vector<std::string> mismatches() const;

 protected:
  /// The settings, checked. InvalidArgument, or as MessageCodec::of().
  struct Facts {
    segue::ros2::MessageCodec codec;
    segue::ros2::Endpoint own;
  };
  static segue::Result<Facts> check(const TopicSettings& settings, bool publishes,
                                    segue::ros2::InterfaceLibrary& library);

  TopicEndpoint(std::shared_ptr<Participant> participant, TopicPort port, Facts facts);
  ~TopicEndpoint() = default;

  /// Has changed() called for changes of the graph, and once now.
  void watch();
  /// To be called first by destructors of derived classes.
  void stop_watching() { participant_->stop_watching(this); }
  /// The graph has changed: logs each mismatch that is new and has its name, up to a bound. In threads of
  /// Fast DDS.
  virtual void changed();

  [[nodiscard]] Participant& participant() const { return *participant_; }
  [[nodiscard]] const TopicPort& port_facts() const { return port_; }
  [[nodiscard]] const segue::ros2::MessageCodec& codec() const { return codec_; }
  [[nodiscard]] const segue::ros2::Quality& quality() const { return own_.quality; }
  [[nodiscard]] TopicName topic_name() const { return {own_.topic, own_.type}; }
  /// PortOptions::topic
  [[nodiscard]] std::string topic_of_port() const;
  /// Of the endpoint: the hash of its type.
  [[nodiscard]] std::string user_data() const { return "typehash=" + own_.type_hash + ";"; }
  void set_matched(std::int32_t count) { matched_ = static_cast<std::uint32_t>(std::max(count, 0)); }
  [[nodiscard]] std::uint32_t matched() const { return matched_; }
  /// Counts and logs that a deadline was missed or that liveliness was lost. In threads of Fast DDS.
  void missed(const std::string& what, std::uint32_t times);
  [[nodiscard]] std::uint64_t missed() const { return missed_; }
  /// Those of mismatches_of() of the graph, and what a derived class knows.
  [[nodiscard]] virtual std::vector<segue::ros2::Mismatch> find_mismatches() const;

 private:
  const std::shared_ptr<Participant> participant_;
  const TopicPort port_;
  const segue::ros2::MessageCodec codec_;
  const segue::ros2::Endpoint own_;
  std::atomic<std::uint32_t> matched_{0};
  std::atomic<std::uint64_t> missed_{0};
  segue::Mutex said_mutex_;
  std::set<std::string> said_ SEGUE_GUARDED_BY(said_mutex_);  ///< since nothing was there to be said
};

}  // namespace ros2

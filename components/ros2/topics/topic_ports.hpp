// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../participant/types.hpp"
#include "topic_reader.hpp"
#include "topic_writer.hpp"

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/type/value.hpp>

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace ros2 {

/// The topics of a node by the names of their ports.
using TopicMap = std::map<std::string, TopicSettings>;

/// Reads the property `publishes` or `subscribes`. InvalidArgument, with the place where it does not fit;
/// topics are as they are written.
segue::Result<TopicMap> read_topics(const segue::type::Value& topics, std::string_view path);

/// The ports of a node's task: what the node publishes goes out of outputs, what it subscribes to comes from
/// inputs.
class TopicPorts {
 public:
  /// Both maps with topics as resolve_topic() gives them.
  struct Wanted {
    TopicMap publishes;
    TopicMap subscribes;
    std::vector<std::string> ready;  ///< those of `publishes` for whose first sample await_samples() waits
  };
  /// InvalidArgument where one name stands for two ports, or `ready` for none.
  static segue::Result<void> check(const Wanted& wanted);

  /// In on_configure, after check(). Makes all or none; fails as TopicReader::make() does.
  segue::Result<void> open(segue::task::Component& component, const std::string& task,
                           const std::string& node, const std::shared_ptr<Participant>& participant,
                           segue::ros2::InterfaceLibrary& library, const Wanted& wanted);
  void close();

  /// From here on, until stop(), samples of the node go out.
  void start();
  void stop();
  /// After start(): until each port of `ready` has had a sample, or `gives_up` says so. DeadlineExceeded
  /// names those that had none, and why that may be.
  segue::Result<void> await_samples(segue::TimePoint deadline, const std::function<bool()>& gives_up) const;
  /// Sends what waits at the inputs, but not more than an update should.
  void send();

  /// For the thread of the task.
  [[nodiscard]] NodeStatistics statistics() const;
  [[nodiscard]] std::vector<std::string> mismatches() const;
  /// The endpoints, publishers first.
  [[nodiscard]] std::pair<std::vector<segue::ros2::Gid>, std::vector<segue::ros2::Gid>> gids() const;

 private:
  /// Those of `ready` that have had no sample.
  [[nodiscard]] std::vector<const TopicReader*> missing() const;

  std::vector<std::unique_ptr<TopicReader>> readers_;
  std::vector<std::unique_ptr<TopicWriter>> writers_;
  std::vector<std::string> ready_;
};

}  // namespace ros2

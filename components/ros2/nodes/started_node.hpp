// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../participant/participant.hpp"
#include "../participant/types.hpp"
#include "../services/requester.hpp"
#include "node_process.hpp"

#include <segue/base/result.hpp>
#include <segue/type/value.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace ros2 {

/// A node's name, place and parameters.
struct NodeStart {
  std::string name;  ///< "/robot/talker"
  ProcessSettings process;
  segue::type::Value parameters;  ///< a map, as parameters_request() takes it
  segue::type::Value request;     ///< what that makes of it
};

/// InvalidArgument where the settings contradict each other or name a file in place of a package or a
/// program.
segue::Result<void> check(const ProcessSettings& process);

/// A node that this process has started: as a program of its own, or in a container, which all nodes of this
/// process that name it share. Any thread, but start() and finish().
class StartedNode {
 public:
  /// Does not wait until the node is seen, but until it is loaded where it is in a container. NotFound: there
  /// is no such installation, package or program; DeadlineExceeded, Unavailable: the container does not
  /// answer; InvalidState: it refuses to load the node, or has ended.
  static segue::Result<std::unique_ptr<StartedNode>> start(const std::shared_ptr<Participant>& participant,
                                                           const NodeStart& start, segue::TimePoint deadline);
  ~StartedNode();
  StartedNode(const StartedNode&) = delete;
  StartedNode& operator=(const StartedNode&) = delete;

  /// How its process has ended, as NodeProcess::end(); empty while it runs, and for a container that ran
  /// already.
  [[nodiscard]] std::string end() const;
  /// How many participants had been seen when its process was started (NodeGraph::seen_so_far()), so that it
  /// is none of these; 0 where that was not started here.
  [[nodiscard]] std::uint64_t seen_before() const { return seen_before_; }
  /// Takes it out of its container, or ends its process, as NodeProcess::finish() does.
  segue::Result<void> finish(segue::TimePoint deadline);
  /// As NodeProcess::watch(); one at a time.
  void watch(std::function<void()> ended);
  void stop_watching();
  /// Can be read from when its process has ended; -1 where that was not started here.
  [[nodiscard]] int descriptor() const;

 private:
  StartedNode() = default;
  segue::Result<void> load(const std::shared_ptr<Participant>& participant, const NodeStart& start,
                           segue::TimePoint deadline);
  segue::Result<void> unload(segue::TimePoint deadline);
  std::shared_ptr<NodeProcess> leave_process();

  std::shared_ptr<NodeProcess> process_;  ///< nullptr: a container that ran already
  std::uint64_t seen_before_ = 0;
  std::unique_ptr<Requester> load_;
  std::unique_ptr<Requester> unload_;
  std::optional<std::uint64_t> loaded_;  ///< its number in the container
};

}  // namespace ros2

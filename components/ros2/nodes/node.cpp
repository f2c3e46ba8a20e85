// SPDX-License-Identifier: Apache-2.0
#include "node_proxy.hpp"

#include <segue/base/text.hpp>

#include <chrono>
#include <memory>
#include <thread>

namespace ros2 {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// A node of ROS 2 without a life cycle as a task. It acts as long as it lives; so where the task starts it,
/// it lives from start to stop, unless `ahead` lets it live from configure to cleanup. While the task runs,
/// that the node is not seen is an error, from which the task recovers when it is seen; the end of a process
/// that it started is an exception.
class Node final : public NodeProxy {
 public:
  Node() : NodeProxy("Stands for a node of ROS 2 without a life cycle, and can start it") {}

 protected:
  segue::Result<void> on_configure() override {
    if (auto joined = join_checked(); !joined) return joined;
    auto done = begin(!starts_node() || *ahead_, deadline());
    if (!done) leave_all();
    return done;
  }

  segue::Result<void> on_start() override {
    const segue::TimePoint end = deadline();
    open_ports();
    auto done = begin(starts_node() && !*ahead_, end);
    if (done) done = wait_until_seen(end);
    if (done) done = finish_start(end);
    if (!done) on_stop();
    return done;
  }

  void on_update() override {
    if (look() && !is_seen()) error(unseen_, "node " + node() + " is not seen");
  }

  void on_error() override {
    if (look() && is_seen()) recovered();
  }

  void on_stop() override {
    close_ports();
    if (starts_node() && !*ahead_) finish_node();
  }

  void on_cleanup() override {
    if (is_seen()) give_parameters_back();
    leave_all();
  }

 private:
  [[nodiscard]] bool is_seen() const { return sees_node(); }

  /// Starts the node, or finds it and sets its parameters, where this is the time for it.
  segue::Result<void> begin(bool is_time, segue::TimePoint end) {
    if (!is_time) return {};
    if (auto started = start_node(end); !started) return started;
    announce_requesters({});
    if (auto seen = wait_until_seen(end); !seen) return seen;
    return set_parameters(end);
  }

  segue::Result<void> wait_until_seen(segue::TimePoint end) {
    constexpr std::chrono::milliseconds kBetweenLooks{10};
    while (!is_seen()) {
      const bool is_late = segue::monotonic_now() >= end;
      if (!is_late && end_of_process().empty()) {
        std::this_thread::sleep_for(kBetweenLooks);
        continue;
      }
      return cause_of(segue::fail(segue::ErrorCode::Unavailable, "node " + node() + " is not seen"));
    }
    return {};
  }

  Property<bool> ahead_{
      *this, "ahead", false, {.doc = "a process that is started lives from configure on, not from start on"}};
};

}  // namespace ros2

SEGUE_COMPONENT(ros2::Node)

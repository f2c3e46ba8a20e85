// SPDX-License-Identifier: Apache-2.0
#include "lifecycle_client.hpp"
#include "node_proxy.hpp"

#include <segue/base/text.hpp>

#include <atomic>
#include <memory>

namespace ros2 {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// A managed node of ROS 2 as a task: configure starts its process where that is wanted, sets its parameters
/// and configures it, start activates, stop deactivates, and cleanup cleans up and ends what was started. A
/// node that runs already is taken from whatever state it is in to the one that is wanted. While it runs, its
/// state is read every second: another one than active is an exception, as is the end of its process; that
/// the node is not seen is an error, from which the task recovers when it is seen and active.
class ManagedNode final : public NodeProxy {
 public:
  ManagedNode() : NodeProxy("Drives a managed node of ROS 2") {}

 protected:
  segue::Result<void> on_configure() override {
    if (auto joined = join_checked(); !joined) return joined;
    auto done = configure();
    if (!done) let_go();
    return done;
  }

  segue::Result<void> on_start() override {
    const segue::TimePoint end = deadline();
    client_->forget();
    told_ = NodeState::Unknown;
    open_ports();
    auto done = drive(NodeState::Active, end);
    if (done) {
      done = finish_start(end);
      // It acts already, and is to act no longer than the task runs.
      if (!done) static_cast<void>(drive(NodeState::Inactive, deadline()));
    }
    if (!done) close_ports();
    return done;
  }

  void on_update() override {
    if (!look()) return;
    if (!client_->is_seen()) return error(unseen_, "the services of its life cycle are not seen");
    check_active();
  }

  void on_error() override {
    if (look() && client_->is_seen() && check_active()) recovered();
  }

  void on_stop() override {
    close_ports();
    if (auto done = drive(NodeState::Inactive, deadline()); !done)
      exception("the node cannot be deactivated: " + segue::to_string(done.error()));
  }

  void on_cleanup() override {
    if (client_ != nullptr && end_of_process().empty()) {
      if (auto done = drive(NodeState::Unconfigured, deadline()); done) {
        give_parameters_back();
      } else {
        log(segue::LogLevel::Warning, "the node cannot be cleaned up: " + segue::to_string(done.error()));
      }
    }
    let_go();
  }

 private:
  /// Whether the node has said that it is active. Another state is an exception. Where it has said nothing,
  /// it is asked, and brings about the next update; samples do not wait for that.
  bool check_active() {
    const NodeState state = told_.exchange(NodeState::Unknown);
    if (state == NodeState::Unknown) {
      client_->ask([this](NodeState told) {
        told_ = told;
        look_now();
      });
      return false;
    }
    if (state == NodeState::Active && !client_->is_there_twice()) return true;
    const auto inactive = segue::fail(segue::ErrorCode::InvalidState,
                                      "the node is " + std::string(to_string(state)) + ", not active");
    exception(client_->there_twice_or(inactive).message);
    return false;
  }

  segue::Result<void> configure() {
    const segue::TimePoint end = deadline();
    auto made = LifecycleClient::make(shared_participant(), node());
    if (!made) return made.error();
    client_ = std::move(*made);
    if (auto started = start_node(end); !started) return started;
    announce_requesters(client_->requesters());
    if (auto fresh = drive(NodeState::Unconfigured, end); !fresh) return fresh;
    if (auto set = set_parameters(end); !set) return set;
    auto done = drive(NodeState::Inactive, end);
    if (!done && answers(done.error())) give_parameters_back();
    return done;
  }

  /// A node that is silent is not waited for once more.
  static bool answers(const segue::Error& failure) {
    return failure.code != segue::ErrorCode::DeadlineExceeded &&
           failure.code != segue::ErrorCode::Unavailable;
  }

  /// As LifecycleClient::drive(), until the process of the node ends.
  segue::Result<void> drive(NodeState goal, segue::TimePoint end) {
    segue::Result<void> done;
    {
      const Watch watch(started(), [this] { client_->cancel(); });
      done = client_->drive(goal, end);
    }
    return done ? done : cause_of(std::move(done.error()));
  }

  void let_go() {
    client_.reset();
    leave_all();
  }

  std::atomic<NodeState> told_{NodeState::Unknown};  ///< by the node, and not looked at yet
  std::unique_ptr<LifecycleClient> client_;
};

}  // namespace ros2

SEGUE_COMPONENT(ros2::ManagedNode)

// SPDX-License-Identifier: Apache-2.0
#include "lifecycle_client.hpp"
#include "node_proxy.hpp"

#include <segue/base/text.hpp>

#include <chrono>
#include <memory>

namespace ros2 {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// How long a running node has for saying its state.
constexpr std::chrono::seconds kAnswersWithin{1};

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
    if (auto active = drive(NodeState::Active, deadline()); !active) return active;
    return trigger_looks();
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
    if (auto done = drive(NodeState::Inactive, deadline()); !done)
      exception("the node cannot be deactivated: " + segue::to_string(done.error()));
  }

  void on_cleanup() override {
    if (end_of_process().empty()) {
      if (auto done = drive(NodeState::Unconfigured, deadline()); !done)
        log(segue::LogLevel::Warning, "the node cannot be cleaned up: " + segue::to_string(done.error()));
    }
    let_go();
  }

 private:
  /// Whether the node says that it is active. Another state is an exception; no answer is none.
  bool check_active() {
    const auto state = client_->state(segue::monotonic_now() + kAnswersWithin);
    if (!state) return false;
    if (*state == NodeState::Active && !client_->is_there_twice()) return true;
    const auto inactive = segue::fail(segue::ErrorCode::InvalidState,
                                      "the node is " + std::string(to_string(*state)) + ", not active");
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
    return drive(NodeState::Inactive, end);
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
    if (client_ != nullptr) withdraw();
    client_.reset();
    finish_node();
    leave();
  }

  std::unique_ptr<LifecycleClient> client_;
};

}  // namespace ros2

SEGUE_COMPONENT(ros2::ManagedNode)

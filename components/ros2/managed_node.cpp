// SPDX-License-Identifier: Apache-2.0
#include "lifecycle_client.hpp"
#include "node_task.hpp"

#include <segue/base/text.hpp>
#include <segue/ros2/dds_names.hpp>
#include <segue/ros2/parameter_value.hpp>
#include <segue/task/sub_state.hpp>

#include <chrono>
#include <memory>

namespace ros2 {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

/// How often the state of a running node is looked at.
constexpr std::chrono::seconds kLook{1};

/// A managed node of ROS 2 that runs somewhere, as a task: configure sets its parameters and configures it,
/// start activates, stop deactivates, and cleanup cleans it up. Whatever state it is found in, it is taken to
/// the one that is wanted. While it runs, its state is read every second: another one than active is an
/// exception; that the node is not seen is an error, from which the task recovers when it is seen and active.
class ManagedNode final : public NodeTask {
 public:
  ManagedNode() : NodeTask({.doc = "Drives a managed node of ROS 2", .activity = segue::periodic(kLook)}) {}

 protected:
  segue::Result<void> on_configure() override {
    if (*timeout_ <= std::chrono::nanoseconds(0))
      return segue::fail(segue::ErrorCode::InvalidArgument, "timeout must be positive");
    if (auto valid = segue::ros2::dds_topic_name(*managed_); !valid) {
      return segue::fail(segue::ErrorCode::InvalidArgument,
                         "managed: " + segue::quote(*managed_) + " is not a valid name of a node");
    }
    auto parameters = segue::ros2::parameters_request(parameters_.value(), "parameters");
    if (!parameters) return parameters.error();
    if (auto joined = join(); !joined) return joined;
    if (auto done = configure(*parameters); !done) {
      withdraw_client();
      return done;
    }
    return {};
  }

  segue::Result<void> on_start() override { return client_->drive(NodeState::Active, deadline()); }

  void on_update() override {
    if (!client_->is_seen()) return error(unseen_, "the services of its life cycle are not seen");
    check_active();
  }

  void on_error() override {
    if (client_->is_seen() && check_active()) recovered();
  }

  void on_stop() override {
    if (auto done = client_->drive(NodeState::Inactive, deadline()); !done)
      exception("the node cannot be deactivated: " + segue::to_string(done.error()));
  }

  void on_cleanup() override {
    if (auto done = client_->drive(NodeState::Unconfigured, deadline()); !done)
      log(segue::LogLevel::Warning, "the node cannot be cleaned up: " + segue::to_string(done.error()));
    withdraw_client();
  }

 private:
  [[nodiscard]] segue::TimePoint deadline() const { return segue::Deadline(*timeout_); }

  /// Whether the node says that it is active. Another state is an exception; no answer is none.
  bool check_active() {
    const auto state = client_->state(segue::monotonic_now() + kLook);
    if (!state) return false;
    if (*state == NodeState::Active) return true;
    exception("the node is " + std::string(to_string(*state)) + ", not active");
    return false;
  }

  segue::Result<void> configure(const segue::type::Value& parameters) {
    auto made = LifecycleClient::make(shared_participant(), *managed_);
    if (!made) return made.error();
    client_ = std::move(*made);
    announce(client_->publishers(), client_->subscriptions());
    const segue::TimePoint end = deadline();
    if (auto fresh = client_->drive(NodeState::Unconfigured, end); !fresh) return fresh;
    if (!parameters.find("parameters")->as_list().empty()) {
      if (auto set = client_->set_parameters(parameters, end); !set) return set;
    }
    return client_->drive(NodeState::Inactive, end);
  }

  void withdraw_client() {
    if (client_ != nullptr) withdraw();
    client_.reset();
    leave();
  }

  Property<std::string> managed_{*this, "managed", {}, {.doc = "name of the node: /robot/talker"}};
  DynamicProperty parameters_{*this,
                              "parameters",
                              "",
                              segue::type::Value::map({}),
                              {.doc = "of the node, before it is configured: {rate: 10, pid: {gain: 0.5}}"}};
  Property<std::chrono::nanoseconds> timeout_{
      *this, "timeout", std::chrono::seconds(10), {.doc = "the longest time for each change of its state"}};
  ErrorState unseen_{*this, "unseen"};
  std::unique_ptr<LifecycleClient> client_;
};

}  // namespace ros2

SEGUE_COMPONENT(ros2::ManagedNode)

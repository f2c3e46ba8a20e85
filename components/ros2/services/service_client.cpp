// SPDX-License-Identifier: Apache-2.0
#include "../participant/node_task.hpp"
#include "requester.hpp"

#include <segue/task/operation.hpp>

#include <chrono>
#include <memory>

namespace ros2 {

using namespace segue::task;  // NOLINT(google-build-using-namespace)

static segue::Activity in_shared_clients() {
  segue::Activity activity;
  activity.thread = "ros2_clients";
  return activity;
}

/// Calls a service of ROS 2: its operation `call` has the request's fields in `request`, and returns the
/// response. Only while the task runs; whatever stops it ends calls in progress.
class ServiceClient final : public NodeTask {
 public:
  ServiceClient()
      : NodeTask({.doc = "Calls a service of ROS 2", .activity = in_shared_clients()}),
        call_(*this,
              {"call",
               {{"request", nullptr, ""}},
               "",
               RunsIn::CallerThread,
               "sends a request, {data: true}, and returns the response; fields that are left out have their "
               "defaults"},
              [this](const std::vector<segue::type::Value>& arguments) { return call(arguments.front()); }) {}

 protected:
  segue::Result<void> on_configure() override {
    if (*timeout_ <= std::chrono::nanoseconds(0))
      return segue::fail(segue::ErrorCode::InvalidArgument, "timeout must be positive");
    if (auto joined = join(); !joined) return joined;
    auto interfaces = library();
    auto made = Requester::make(shared_participant(), interfaces, *service_, *type_);
    if (!made) {
      leave();
      return made.error();
    }
    const segue::Lock lock(mutex_);
    requester_ = std::move(*made);
    call_timeout_ = *timeout_;
    announce({requester_->publisher()}, {requester_->subscription()});
    return {};
  }

  segue::Result<void> on_start() override {
    const segue::Lock lock(mutex_);
    requester_->allow(true);
    return {};
  }

  void on_update() override {}

  void on_stop() override {
    const segue::Lock lock(mutex_);
    requester_->allow(false);
  }

  void on_cleanup() override {
    withdraw();
    std::shared_ptr<Requester> ended;
    {
      const segue::Lock lock(mutex_);
      ended = std::move(requester_);
    }
    ended.reset();
    leave();
  }

 private:
  /// In the thread of the caller; keeps the requester, and with it the participant, until the call has ended.
  segue::Result<segue::type::Value> call(const segue::type::Value& request) {
    segue::Lock lock(mutex_);
    const std::shared_ptr<Requester> requester = requester_;
    const segue::Deadline deadline(call_timeout_);
    lock.unlock();
    if (requester == nullptr)
      return segue::fail(segue::ErrorCode::InvalidState, "no service is called: the task is not configured");
    return requester->call(request, deadline);
  }

  std::uint32_t servers() {
    const segue::Lock lock(mutex_);
    return requester_ == nullptr ? 0 : requester_->servers();
  }

  Property<std::string> service_{*this, "service", {}, {.doc = "name of the service: /add_two_ints"}};
  Property<std::string> type_{*this, "type", {}, {.doc = "its interface: std_srvs/srv/SetBool"}};
  Property<std::chrono::nanoseconds> timeout_{*this,
                                              "timeout",
                                              std::chrono::seconds(5),
                                              {.doc = "how long a call waits for a server and its response"}};
  DynamicOperation call_;
  Operation<std::uint32_t()> servers_{*this,
                                      "servers",
                                      {},
                                      [this] { return servers(); },
                                      RunsIn::CallerThread,
                                      "how many servers there are now"};
  segue::Mutex mutex_;
  std::shared_ptr<Requester> requester_ SEGUE_GUARDED_BY(mutex_);
  std::chrono::nanoseconds call_timeout_ SEGUE_GUARDED_BY(mutex_){};
};

}  // namespace ros2

SEGUE_COMPONENT(ros2::ServiceClient)

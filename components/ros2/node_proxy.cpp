// SPDX-License-Identifier: Apache-2.0
#include "node_proxy.hpp"

#include <segue/base/error.hpp>
#include <segue/base/text.hpp>
#include <segue/ros2/dds_names.hpp>
#include <segue/ros2/parameter_value.hpp>

#include <sys/timerfd.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <utility>

namespace ros2 {

using segue::ErrorCode;
using segue::fail;
using segue::Result;
using segue::type::Value;

namespace {

bool is_empty(const Value& parameters) {
  return parameters.is_map() && parameters.as_map().empty();
}

}  // namespace

NodeProxy::NodeProxy(std::string doc)
    : NodeTask({.doc = std::move(doc), .activity = segue::fd_driven(), .descriptors = {"timer", "process"}}) {
}

Result<void> NodeProxy::join_checked() {
  if (*timeout_ <= std::chrono::nanoseconds(0))
    return fail(ErrorCode::InvalidArgument, "timeout must be positive");
  if (auto valid = segue::ros2::dds_topic_name(*name_); !valid || !name_->starts_with('/')) {
    return fail(ErrorCode::InvalidArgument,
                "name: " + segue::quote(*name_) +
                    " is not a valid name of a node: expected /NAME or /NAMESPACE/NAME");
  }
  if (auto checked = check(*process_); !checked) return checked;
  if (auto request = segue::ros2::parameters_request(parameters_.value(), "parameters"); !request)
    return request.error();
  return join("segue_");  // beside the node, which may have the name of the task
}

Result<void> NodeProxy::start_node(segue::TimePoint deadline) {
  if (!starts_node()) return is_empty(parameters_.value()) ? Result<void>() : make_parameter_client();
  auto started = StartedNode::start(shared_participant(), {*name_, *process_, parameters_.value()}, deadline);
  if (!started) return started.error();
  started_ = std::move(*started);
  return {};
}

void NodeProxy::finish_node() {
  if (started_) {
    if (auto finished = started_->finish(deadline()); !finished)
      log(segue::LogLevel::Warning, "node " + *name_ + ": " + segue::to_string(finished.error()));
  }
  started_.reset();
  parameter_client_.reset();
}

Result<void> NodeProxy::make_parameter_client() {
  auto client = ParameterClient::make(shared_participant(), *name_);
  if (!client) return client.error();
  parameter_client_ = std::move(*client);
  return {};
}

Result<void> NodeProxy::set_parameters(segue::TimePoint deadline) {
  return parameter_client_ ? request_parameters(parameters_.value(), deadline) : Result<void>();
}

Result<void> NodeProxy::request_parameters(const Value& parameters, segue::TimePoint deadline) {
  auto request = segue::ros2::parameters_request(parameters, "parameters");
  if (!request) return request.error();
  Result<void> done;
  {
    const Watch watch(started_.get(), [this] { parameter_client_->cancel(); });
    done = parameter_client_->set(*request, deadline);
  }
  return done ? done : cause_of(std::move(done.error()));
}

Result<void> NodeProxy::set_live(const Value& parameters) {
  if (starts_node() && !started_) return {};  // it gets them when it is started
  if (!parameter_client_) {
    if (auto made = make_parameter_client(); !made) return made;
    announce_requesters(requesters_);
  }
  return request_parameters(parameters, deadline());
}

segue::Error NodeProxy::cause_of(segue::Error failure) const {
  const std::string end = end_of_process();
  if (end.empty()) return failure;
  return fail(ErrorCode::InvalidState,
              "the process of node " + *name_ + " " + end + "; its output is in the log of this process");
}

Result<void> NodeProxy::trigger_looks() {
  timer_ = segue::Descriptor(::timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK));
  const itimerspec every_second = {{1, 0}, {1, 0}};
  if (!timer_.valid() || ::timerfd_settime(timer_.get(), 0, &every_second, nullptr) != 0)
    return segue::system_error("cannot make a timer", errno);
  if (auto done = trigger_fd(timer_.get(), "timer"); !done) return done;
  return started_ && started_->descriptor() >= 0 ? trigger_fd(started_->descriptor(), "process")
                                                 : Result<void>();
}

bool NodeProxy::look() {
  std::uint64_t expired = 0;
  (void)!::read(timer_.get(), &expired, sizeof expired);
  const std::string end = end_of_process();
  if (end.empty()) return true;
  exception("the process of node " + *name_ + " " + end);
  return false;
}

void NodeProxy::announce_requesters(std::vector<const Requester*> requesters) {
  requesters_ = requesters;
  if (parameter_client_) requesters.push_back(&parameter_client_->requester());
  std::vector<segue::ros2::Gid> publishers;
  std::vector<segue::ros2::Gid> subscriptions;
  for (const Requester* requester : requesters) {
    publishers.push_back(requester->publisher());
    subscriptions.push_back(requester->subscription());
  }
  announce(std::move(publishers), std::move(subscriptions));
}

}  // namespace ros2

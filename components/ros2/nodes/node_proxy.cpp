// SPDX-License-Identifier: Apache-2.0
#include "node_proxy.hpp"

#include <segue/base/error.hpp>
#include <segue/base/text.hpp>
#include <segue/ros2/dds_names.hpp>
#include <segue/ros2/node_topics.hpp>

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

/// Names of ports as read_topics() permits them.
constexpr const char* kPortPattern = "[A-Za-z0-9_][A-Za-z0-9_.:-]*";

}  // namespace

NodeProxy::NodeProxy(std::string doc)
    : NodeTask({.doc = std::move(doc), .descriptors = {"timer", "process"}}) {
  dynamic_ports(segue::task::Direction::Output, kPortPattern, "those of publishes, with the topic's type");
  dynamic_ports(segue::task::Direction::Input, kPortPattern, "those of subscribes, with the topic's type");
}

Result<void> NodeProxy::check_topics(const Value& topics, std::string_view path) {
  auto read = read_topics(topics, path);
  return read ? Result<void>() : read.error();
}

Result<TopicPorts::Wanted> NodeProxy::wanted_ports() const {
  TopicPorts::Wanted wanted{{}, {}, *ready_};
  for (const auto& [property, topics] :
       {std::pair{&publishes_, &wanted.publishes}, {&subscribes_, &wanted.subscribes}}) {
    auto read = read_topics(property->value(), property->name());
    if (!read) return read.error();
    *topics = std::move(*read);
    for (auto& [port, settings] : *topics) {
      auto topic = segue::ros2::resolve_topic(settings.topic, *name_, process_->remappings);
      if (!topic)
        return fail(ErrorCode::InvalidArgument, property->name() + "." + port + ": " + topic.error().message);
      settings.topic = std::move(*topic);
    }
  }
  if (auto checked = TopicPorts::check(wanted); !checked) return checked.error();
  return wanted;
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
  if (auto wanted = node_parameters_.want(parameters_.value()); !wanted) return wanted;
  const auto ports = wanted_ports();
  if (!ports) return ports.error();
  timer_ = segue::Descriptor(::timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK));
  if (!timer_.valid()) return segue::system_error("cannot make a timer", errno);
  if (auto joined = join("_segue_"); !joined)
    return joined;  // beside the node, which may be named as the task
  auto interfaces = library();
  auto opened = ports_.open(*this, id(), *name_, shared_participant(), interfaces, *ports);
  if (opened) {
    announce_requesters({});
  } else {
    leave();
  }
  return opened;
}

void NodeProxy::leave_all() {
  withdraw();
  finish_node();
  ports_.close();
  leave();
}

Result<void> NodeProxy::start_node(segue::TimePoint deadline) {
  if (auto watched = node_parameters_.watch(shared_participant(), *name_); !watched) return watched;
  if (!starts_node()) {
    return node_parameters_.empty() ? Result<void>() : node_parameters_.open(shared_participant(), *name_);
  }
  auto started = StartedNode::start(
      shared_participant(), {*name_, *process_, parameters_.value(), node_parameters_.request()}, deadline);
  if (!started) return started.error();
  started_ = std::move(*started);
  node_parameters_.were_given();
  return {};
}

void NodeProxy::finish_node() {
  if (started_) {
    if (auto finished = started_->finish(deadline()); !finished)
      log(segue::LogLevel::Warning, "node " + *name_ + ": " + segue::to_string(finished.error()));
  }
  started_.reset();
  node_parameters_.close();
}

Result<void> NodeProxy::set_parameters(segue::TimePoint deadline) {
  if (!node_parameters_.is_open()) return {};
  const Watch watch(started_.get(), [this] { node_parameters_.cancel(); });
  auto done = node_parameters_.set(deadline);
  return done ? done : cause_of(std::move(done.error()));
}

void NodeProxy::give_parameters_back() {
  if (starts_node()) return;
  if (auto done = node_parameters_.give_back(deadline()); !done)
    log(segue::LogLevel::Warning,
        "node " + *name_ + " keeps the parameters that this task has set: " + segue::to_string(done.error()));
}

Result<void> NodeProxy::set_live(const Value& parameters) {
  if (auto wanted = node_parameters_.want(parameters); !wanted) return wanted;
  if (starts_node() && !started_) return {};  // it gets them when it is started
  auto done = node_parameters_.is_complete() ? Result<void>() : open_parameters();
  if (done) done = set_parameters(deadline());
  if (!done) static_cast<void>(node_parameters_.want(parameters_.value()));
  for (const std::string& name : done ? node_parameters_.kept() : std::vector<std::string>())
    log(segue::LogLevel::Warning, "node " + *name_ + " keeps parameter " + name +
                                      ", which is not named any more: its value before is not known");
  return done;
}

Result<void> NodeProxy::open_parameters() {
  if (auto opened = node_parameters_.open(shared_participant(), *name_); !opened) return opened;
  if (auto watched = node_parameters_.watch(shared_participant(), *name_); !watched) return watched;
  announce_requesters(requesters_);
  return {};
}

bool NodeProxy::sees_node() const {
  return shared_participant()->sees_node(*name_, started_ ? started_->seen_before() : 0);
}

segue::Error NodeProxy::cause_of(segue::Error failure) const {
  const std::string end = end_of_process();
  if (end.empty()) return failure;
  return fail(ErrorCode::InvalidState,
              "the process of node " + *name_ + " " + end + "; its output is in the log of this process");
}

Result<void> NodeProxy::finish_start(segue::TimePoint deadline) {
  auto ready = ports_.await_samples(deadline, [this] { return !end_of_process().empty(); });
  if (!ready) return cause_of(std::move(ready.error()));
  return trigger_looks();
}

Result<void> NodeProxy::trigger_looks() {
  const itimerspec every_second = {{1, 0}, {1, 0}};
  if (::timerfd_settime(timer_.get(), 0, &every_second, nullptr) != 0)
    return segue::system_error("cannot set a timer", errno);
  if (auto done = trigger_fd(timer_.get(), "timer"); !done) return done;
  return started_ && started_->descriptor() >= 0 ? trigger_fd(started_->descriptor(), "process")
                                                 : Result<void>();
}

void NodeProxy::look_now() const {
  const itimerspec now = {{1, 0}, {0, 1}};
  ::timerfd_settime(timer_.get(), 0, &now, nullptr);
}

bool NodeProxy::look() {
  ports_.send();
  const std::string end = end_of_process();
  if (!end.empty()) {
    exception("the process of node " + *name_ + " " + end);
    return false;
  }
  std::uint64_t expired = 0;
  if (::read(timer_.get(), &expired, sizeof expired) != sizeof expired) return false;
  for (const std::string& text : node_parameters_.newly_changed())
    log(segue::LogLevel::Warning, "node " + *name_ + ": somebody else has changed a parameter: " + text);
  return true;
}

void NodeProxy::announce_requesters(std::vector<const Requester*> requesters) {
  requesters_ = std::move(requesters);
  auto [publishers, subscriptions] = ports_.gids();
  node_parameters_.add_gids(publishers, subscriptions);
  for (const Requester* requester : requesters_) {
    publishers.push_back(requester->publisher());
    subscriptions.push_back(requester->subscription());
  }
  announce(std::move(publishers), std::move(subscriptions));
}

}  // namespace ros2

// SPDX-License-Identifier: Apache-2.0
#include "lifecycle_client.hpp"

#include <segue/base/clock.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <thread>
#include <utility>

namespace ros2 {
namespace {

using segue::ErrorCode;
using segue::fail;
using segue::type::Value;

/// How often a node in a transition is asked whether that has ended.
constexpr std::chrono::milliseconds kPause{20};

/// A transition by its number in lifecycle_msgs/msg/Transition.
struct Transition {
  int number;
  const char* verb;
  NodeState target;
};

/// From a state that is not the goal, one step nearer.
Transition transition_between(NodeState from, NodeState goal) {
  if (goal > from)
    return from == NodeState::Unconfigured ? Transition{1, "configure", NodeState::Inactive}
                                           : Transition{3, "activate", NodeState::Active};
  return from == NodeState::Active ? Transition{4, "deactivate", NodeState::Inactive}
                                   : Transition{2, "clean up", NodeState::Unconfigured};
}

bool is_in_transition(NodeState state) {
  return state >= NodeState::Configuring;
}

void pause(segue::TimePoint deadline) {
  std::this_thread::sleep_until(std::min(deadline, segue::monotonic_now() + kPause));
}

}  // namespace

std::string_view to_string(NodeState state) {
  switch (state) {
    case NodeState::Unconfigured:
      return "unconfigured";
    case NodeState::Inactive:
      return "inactive";
    case NodeState::Active:
      return "active";
    case NodeState::Finalized:
      return "finalized";
    case NodeState::Configuring:
      return "configuring";
    case NodeState::CleaningUp:
      return "cleaning up";
    case NodeState::ShuttingDown:
      return "shutting down";
    case NodeState::Activating:
      return "activating";
    case NodeState::Deactivating:
      return "deactivating";
    case NodeState::ErrorProcessing:
      return "error processing";
    case NodeState::Unknown:
      break;
  }
  return "unknown";
}

segue::Result<std::unique_ptr<LifecycleClient>> LifecycleClient::make(
    const std::shared_ptr<Participant>& participant, const std::string& node) {
  std::unique_ptr<LifecycleClient> made(new LifecycleClient);
  made->node_ = node;
  segue::ros2::InterfaceLibrary library;
  struct Service {
    std::unique_ptr<Requester>& requester;
    const char* name;
    const char* interface;
  };
  for (const Service& service :
       {Service{made->change_state_, "change_state", "lifecycle_msgs/srv/ChangeState"},
        Service{made->get_state_, "get_state", "lifecycle_msgs/srv/GetState"}}) {
    auto requester = Requester::make(participant, library, node + "/" + service.name, service.interface);
    if (!requester) return requester.error();
    service.requester = std::move(*requester);
    service.requester->allow(true);
  }
  return made;
}

std::vector<const Requester*> LifecycleClient::requesters() const {
  return {change_state_.get(), get_state_.get()};
}

void LifecycleClient::cancel() {
  for (Requester* requester : {change_state_.get(), get_state_.get()})
    requester->allow(false);
}

segue::Result<NodeState> LifecycleClient::state(segue::TimePoint deadline) {
  auto response = get_state_->call(Value(), deadline);
  return response ? state_in(*response) : response.error();
}

void LifecycleClient::forget() {
  get_state_->allow(false);
  get_state_->allow(true);
}

void LifecycleClient::ask(std::function<void(NodeState)> told) {
  forget();
  const auto answer = [this, told = std::move(told)](const segue::Result<Value>& response) {
    if (!response) return;
    if (const auto state = state_in(*response)) told(*state);
  };
  // A server that has left meanwhile is seen to be missing elsewhere.
  static_cast<void>(get_state_->begin(Value(), segue::TimePoint(), answer));
}

segue::Result<NodeState> LifecycleClient::state_in(const Value& response) const {
  const auto number = response.find("current_state")->find("id")->as_int();
  constexpr std::array<std::int64_t, 10> kKnown = {1, 2, 3, 4, 10, 11, 12, 13, 14, 15};
  if (std::ranges::find(kKnown, number) != kKnown.end()) return static_cast<NodeState>(number);
  return fail(ErrorCode::InvalidState, "node " + node_ + " says that its state is number " +
                                           std::to_string(number) + ", which does not exist");
}

segue::Error LifecycleClient::there_twice() const {
  return fail(ErrorCode::InvalidState, "node " + node_ + " is there twice, and both answer: end one");
}

segue::Error LifecycleClient::there_twice_or(segue::Error error) {
  constexpr std::chrono::seconds kBothAnswer{3};
  return get_state_->has_rivals(segue::monotonic_now() + kBothAnswer) ? there_twice() : error;
}

segue::Result<void> LifecycleClient::drive(NodeState goal, segue::TimePoint deadline) {
  NodeState now = NodeState::Unknown;
  while (segue::monotonic_now() < deadline) {
    auto read = state(deadline);
    if (!read) return read.error();
    now = *read;
    if (is_there_twice()) return there_twice();
    if (now == goal) return {};
    if (now == NodeState::Finalized)
      return fail(ErrorCode::InvalidState, "node " + node_ + " is finalized, which it cannot leave");
    if (is_in_transition(now)) {
      pause(deadline);
    } else if (auto stepped = step(now, goal, deadline); !stepped) {
      return stepped;
    }
  }
  return fail(ErrorCode::DeadlineExceeded, "node " + node_ + " is not " + std::string(to_string(goal)) +
                                               " in time; it is " + std::string(to_string(now)));
}

segue::Result<NodeState> LifecycleClient::settled_state(segue::TimePoint deadline) {
  auto read = state(deadline);
  while (read && is_in_transition(*read) && segue::monotonic_now() < deadline) {
    pause(deadline);
    read = state(deadline);
  }
  return read;
}

segue::Result<void> LifecycleClient::step(NodeState from, NodeState goal, segue::TimePoint deadline) {
  const Transition transition = transition_between(from, goal);
  // A response that does not come leaves time to read the state.
  const segue::TimePoint now = segue::monotonic_now();
  auto response = change_state_->call(Value::map({{"transition", Value::map({{"id", transition.number}})}}),
                                      now + (deadline - now) / 2);
  // Without a response, the state tells what has happened.
  const bool says_done = response && response->find("success")->as_bool();
  auto read = settled_state(deadline);
  if (!read) return response ? read.error() : response.error();
  if (*read == transition.target || is_in_transition(*read)) return {};
  if (!response && *read == from) return response.error();
  const char* what = *read != from ? " failed to " : says_done ? " says that it did " : " refuses to ";
  return there_twice_or(fail(ErrorCode::InvalidState, "node " + node_ + what + transition.verb + "; it is " +
                                                          std::string(to_string(*read))));
}

}  // namespace ros2

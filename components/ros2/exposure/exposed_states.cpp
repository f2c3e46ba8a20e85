// SPDX-License-Identifier: Apache-2.0
#include "exposed_states.hpp"

#include <array>
#include <optional>
#include <string_view>

namespace ros2 {

using segue::TaskState;
using segue::type::Value;

namespace {

/// The constants of lifecycle_msgs/msg/State.
enum NodeStates : int {
  kUnconfigured = 1,
  kInactive = 2,
  kActive = 3,
  kFinalized = 4,
  kErrorProcessing = 15
};

struct StateLabel {
  int id;
  std::string_view label;
};
constexpr std::array<StateLabel, 11> kAllNodeStates = {{{0, "unknown"},
                                                        {kUnconfigured, "unconfigured"},
                                                        {kInactive, "inactive"},
                                                        {kActive, "active"},
                                                        {kFinalized, "finalized"},
                                                        {10, "configuring"},
                                                        {11, "cleaningup"},
                                                        {12, "shuttingdown"},
                                                        {13, "activating"},
                                                        {14, "deactivating"},
                                                        {kErrorProcessing, "errorprocessing"}}};

/// One of lifecycle_msgs/msg/Transition.
struct NodeChange {
  int from;
  int to;
  int id;
  std::string_view label;
};
constexpr std::array<NodeChange, 12> kNodeChanges = {
    {{kUnconfigured, kInactive, 1, "configure"},
     {kInactive, kUnconfigured, 2, "cleanup"},
     {kInactive, kActive, 3, "activate"},
     {kActive, kInactive, 4, "deactivate"},
     {kUnconfigured, kErrorProcessing, 12, "transition_error"},
     {kInactive, kErrorProcessing, 32, "transition_error"},
     {kActive, kErrorProcessing, 42, "transition_error"},
     {kErrorProcessing, kUnconfigured, 60, "transition_success"},
     {kErrorProcessing, kFinalized, 61, "transition_failure"},
     {kUnconfigured, kFinalized, 5, "shutdown"},
     {kInactive, kFinalized, 6, "shutdown"},
     {kActive, kFinalized, 7, "shutdown"}}};

int number_of(TaskState state) {
  switch (state) {
    case TaskState::PreOperational:
      return kUnconfigured;
    case TaskState::Stopped:
      return kInactive;
    case TaskState::Running:
    case TaskState::RunTimeError:
      return kActive;
    case TaskState::Exception:
      return kErrorProcessing;
    case TaskState::Fatal:
      return kFinalized;
  }
  return 0;
}

Value node_state(int id) {
  for (const StateLabel& state : kAllNodeStates) {
    if (state.id == id) return Value::map({{"id", id}, {"label", state.label}});
  }
  return Value::map({{"id", 0}, {"label", "unknown"}});
}

Value node_change(const NodeChange& change) {
  return Value::map({{"transition", Value::map({{"id", change.id}, {"label", change.label}})},
                     {"start_state", node_state(change.from)},
                     {"goal_state", node_state(change.to)}});
}

const NodeChange* change_between(int from, int to) {
  for (const NodeChange& change : kNodeChanges) {
    if (change.from == from && change.to == to) return &change;
  }
  return nullptr;
}

/// The state on the way to one that no transition leads to.
int next_on_the_way(int from, int to) {
  if (from == kErrorProcessing) return kUnconfigured;
  return from < to || from == kActive ? kInactive : kUnconfigured;
}

}  // namespace

Value lifecycle_state(TaskState state) {
  return node_state(number_of(state));
}

Value::List transition_events(TaskState from, TaskState to, std::uint64_t time) {
  Value::List events;
  int now = number_of(from);
  const int goal = number_of(to);
  // A finalized node stays so; no way is longer than three transitions.
  for (int step = 0; step < 3 && now != goal && now != kFinalized; ++step) {
    const NodeChange* change = change_between(now, goal);
    if (change == nullptr) change = change_between(now, next_on_the_way(now, goal));
    if (change == nullptr) break;
    Value event = node_change(*change);
    event.as_map().set("timestamp", time);
    events.push_back(std::move(event));
    now = change->to;
  }
  return events;
}

Value::List lifecycle_states() {
  Value::List all;
  for (const StateLabel& state : kAllNodeStates)
    all.push_back(node_state(state.id));
  return all;
}

Value::List lifecycle_transitions() {
  Value::List all;
  for (const NodeChange& change : kNodeChanges)
    all.push_back(node_change(change));
  return all;
}

}  // namespace ros2

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/life_cycle.hpp>
#include <segue/type/value.hpp>

#include <cstdint>

/// The states of a task as those of a managed node: pre-operational is unconfigured, stopped inactive,
/// running and run-time errors active, an exception error processing, fatal finalized.
namespace ros2 {

/// As lifecycle_msgs/msg/State.
segue::type::Value lifecycle_state(segue::TaskState state);
/// Each change between both as lifecycle_msgs/msg/TransitionEvent, in their order: a node does not become
/// active unless it is inactive first, though a task may be seen in fewer states. `time` in nanoseconds.
segue::type::Value::List transition_events(segue::TaskState from, segue::TaskState to, std::uint64_t time);
/// All states of a managed node.
segue::type::Value::List lifecycle_states();
/// The transitions between states of tasks, as lifecycle_msgs/msg/TransitionDescription.
segue::type::Value::List lifecycle_transitions();

}  // namespace ros2

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/control/tasks.capnp.h>
#include <segue/control/detail/model_wire.hpp>
#include <segue/host/task_host.hpp>
#include <segue/task/task.hpp>

/// Encodes and decodes what is said of tasks, wherever they live. As in model_wire.hpp, messages are not
/// trusted, and unknown words in them throw WireError.
namespace segue::control::detail {

void encode(const host::TaskReport& report, wire::TaskReport::Builder builder);
host::TaskReport decode(wire::TaskReport::Reader reader);

void encode(const host::TaskLevel& level, wire::TaskLevel::Builder builder);
host::TaskLevel decode(wire::TaskLevel::Reader reader);

void encode(const host::TaskDetails& details, wire::Details::Builder builder);
host::TaskDetails decode(wire::Details::Reader reader);

void encode(const link::Latency& latency, wire::Latency::Builder builder);
link::Latency decode(wire::Latency::Reader reader);

void encode(const host::ConnectionReport& report, wire::ConnectionReport::Builder builder);
host::ConnectionReport decode(wire::ConnectionReport::Reader reader);

void encode(const task::SavedState& state, wire::State::Builder builder);
task::SavedState decode(wire::State::Reader reader);

void encode(const host::TaskEvent& event, wire::TaskEvent::Builder builder);
host::TaskEvent decode(wire::TaskEvent::Reader reader);

void encode(const host::Completed& ended, wire::Ended::Builder builder);
host::Completed decode(wire::Ended::Reader reader);

}  // namespace segue::control::detail

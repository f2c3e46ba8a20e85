// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/rpc_codecs/tasks.capnp.h>
#include <segue/rpc_codecs/model_wire.hpp>
#include <segue/task/task.hpp>
#include <segue/task_host/task_host.hpp>

/// Encodes and decodes what is said of tasks, wherever they live. As in model_wire.hpp, messages are not
/// trusted, and unknown words in them throw WireError.
namespace segue::control::detail {

void encode(const task_host::TaskReport& report, wire::TaskReport::Builder builder);
task_host::TaskReport decode(wire::TaskReport::Reader reader);

void encode(const task_host::TaskLevel& level, wire::TaskLevel::Builder builder);
task_host::TaskLevel decode(wire::TaskLevel::Reader reader);

void encode(const task_host::TaskDetails& details, wire::Details::Builder builder);
task_host::TaskDetails decode(wire::Details::Reader reader);

void encode(const sample_link::Latency& latency, wire::Latency::Builder builder);
sample_link::Latency decode(wire::Latency::Reader reader);

void encode(const task_host::ConnectionReport& report, wire::ConnectionReport::Builder builder);
task_host::ConnectionReport decode(wire::ConnectionReport::Reader reader);

void encode(const task::SavedState& state, wire::State::Builder builder);
task::SavedState decode(wire::State::Reader reader);

void encode(const task_host::TaskEvent& event, wire::TaskEvent::Builder builder);
task_host::TaskEvent decode(wire::TaskEvent::Reader reader);

void encode(const task_host::Completed& ended, wire::Ended::Builder builder);
task_host::Completed decode(wire::Ended::Reader reader);

}  // namespace segue::control::detail

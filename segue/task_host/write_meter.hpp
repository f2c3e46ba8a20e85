// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task/port.hpp>
#include <segue/task_host/port_reader.hpp>

#include <memory>

namespace segue::task_host::detail {

/// Measures how often, how regularly and how much an output port is written, where it is written: no sample
/// is passed on or kept. A writer pays for reading the clock and adding up. Each read gives one value of what
/// was written since the read before: {"samples", "bytes", "span_s", "mean_s", "least_s", "most_s",
/// "deviation_s"}, the last four of the times between writes; null where there were none. `bytes` are those
/// of the samples as they lie in memory, with what they refer to. The port must exist until this returns; it
/// may be removed later.
Result<std::unique_ptr<PortReader>> measure_writes(task::OutputPortBase& port);

}  // namespace segue::task_host::detail

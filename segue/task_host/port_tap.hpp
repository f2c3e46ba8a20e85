// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task/port.hpp>
#include <segue/task/task.hpp>
#include <segue/task_host/port_reader.hpp>
#include <segue/task_host/watches.hpp>

#include <cstddef>
#include <memory>

namespace segue::task_host::detail {

/// Reads an output port of `task` through a connection of its own, a circular buffer of `buffer` samples. The
/// port must exist until this returns; it may be removed later. Whoever waits for samples waits in `watches`,
/// which must be rung after each update that Task::announce_next_update() has asked for.
Result<std::unique_ptr<PortReader>> tap(task::OutputPortBase& port, std::size_t buffer,
                                        std::shared_ptr<Watches> watches, std::weak_ptr<task::Task> task);

}  // namespace segue::task_host::detail

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/host/task_host.hpp>
#include <segue/task/port.hpp>

#include <memory>

namespace segue::host::detail {

/// Reads an output port through a connection of its own, a circular buffer of `buffer` samples. The port must
/// exist until this returns; it may be removed later.
Result<std::unique_ptr<PortReader>> tap(task::OutputPortBase& port, std::size_t buffer);

}  // namespace segue::host::detail

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/ids.hpp>
#include <segue/task_host/task_host.hpp>

#include <cstdint>
#include <functional>

namespace segue::runtime::detail {

/// The memory in bytes that a process uses now; 0 if it is not known.
using MemoryOf = std::function<std::uint64_t(const model::DeploymentKey& process)>;

/// The resident memory of the processes that have tasks now, on this computer. Asks the host, and blocks
/// meanwhile.
MemoryOf memory_of(const task_host::TaskHost& host);

}  // namespace segue::runtime::detail

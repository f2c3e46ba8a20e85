// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/concurrent/thread_pool.hpp>
#include <segue/fleet/process_record.hpp>
#include <segue/model/network.hpp>

#include <span>
#include <vector>

namespace segue::fleet::detail {

/// A connection between two processes, with plain task ids. When it is to be disconnected, a process that has
/// ended may be null.
struct RemoteConnection {
  model::Connection connection;
  RecordPtr writer;
  RecordPtr reader;
  bool at_commit = false;  ///< made by Prepare of a transition: it begins with its commit
};

/// Makes processes map each other's memory where they have not yet, then connects in two rounds of messages,
/// one for each process: outputs are described while inputs are opened, then outputs are attached. (An input
/// with a type whose output has none is opened again in between.) An input whose output fails is closed
/// again. The outcomes in the order of the connections. Blocks until the deadline at most.
std::vector<Result<void>> connect_all(concurrent::ThreadPool& pool,
                                      std::span<const RemoteConnection> connections, TimePoint deadline);

/// Closes the writers' endpoints, then the readers'. NotFound where neither existed. A connection with only
/// one process left needs no message: forget() ends it together with the other process.
std::vector<Result<void>> disconnect_all(concurrent::ThreadPool& pool,
                                         std::span<const RemoteConnection> connections, TimePoint deadline);

}  // namespace segue::fleet::detail

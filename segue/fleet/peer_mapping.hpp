// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/fleet/fleet.hpp>

#include <set>
#include <utility>
#include <vector>

namespace segue::fleet::detail {

/// Two processes, in either order.
using ProcessPair = std::pair<RecordPtr, RecordPtr>;

/// Two processes that could not map each other's memory.
struct FailedPair {
  ProcessPair pair;
  Error why;
};

/// Makes both processes of every pair map each other's memory, in parallel; nothing is sent where they have
/// done so before. Returns the pairs for which it failed, a pair twice if both directions did. Blocks until
/// `deadline` at most. Only one call at a time for each fleet.
std::vector<FailedPair> map_peers(concurrent::ThreadPool& pool, const std::vector<ProcessPair>& pairs,
                                  TimePoint deadline);

}  // namespace segue::fleet::detail

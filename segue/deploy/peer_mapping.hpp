// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/deploy/fleet.hpp>

#include <set>
#include <utility>
#include <vector>

namespace segue::deploy::detail {

/// Two processes, in any order.
using ProcessPair = std::pair<RecordPtr, RecordPtr>;

struct FailedPair {
  ProcessPair pair;
  Error why;
};

/// Both processes of every pair map each other's memory, once for each pair, all side by side; where they
/// know each other already, nothing is asked. Gives the pairs that could not. One call at a time for a fleet.
std::vector<FailedPair> map_peers(concurrent::ThreadPool& pool, const std::vector<ProcessPair>& pairs,
                                  TimePoint deadline);

}  // namespace segue::deploy::detail

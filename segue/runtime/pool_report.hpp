// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/ids.hpp>

#include <string>
#include <vector>

namespace segue::runtime {

/// An instance of a pool of processes.
struct PoolInstance {
  model::TaskId task;
  bool ready = false;  ///< its operations can be called
  int pid = 0;         ///< of its process; 0: there is none
  /// As many attempts to start it as the policies permit have failed, or it is left as it is.
  bool given_up = false;
  std::string reason;  ///< why it is not ready
  bool busy = false;   ///< an operation is under way
};
/// A pool with its instances.
struct PoolReport {
  std::string pool;
  std::vector<PoolInstance> instances;  ///< that shall run now
  int least = 1;                        ///< how many always run
  int most = 1;                         ///< how many run where as many calls wait
  int waiting = 0;                      ///< callers that wait for an instance
  std::string held_back{};              ///< why no further instance is made for them; empty: nothing does
};

}  // namespace segue::runtime

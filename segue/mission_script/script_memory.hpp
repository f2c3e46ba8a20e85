// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/base/pending_changes.hpp>

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace segue::mission::detail {

/// Tells a Python process which executions' persistent variables count, by state. The process itself has the
/// values; it is told of each decision before its next execution. Thread safe; nothing blocks.
class ScriptMemory {
 public:
  /// The changes of an execution, kept aside. It began with the variables of the execution `from` (0: none).
  static std::shared_ptr<PendingChanges> changes(std::shared_ptr<ScriptMemory> memory, std::string path,
                                                 std::uint64_t execution, std::uint64_t from);
  /// The executions whose variables count, and those whose variables do not, since the last call.
  std::vector<std::pair<std::uint64_t, bool>> take_decisions();
  /// The process has ended, and with it all variables.
  void end();

 private:
  class Changes;

  Mutex mutex_;  ///< guards all
  std::map<std::string, std::uint64_t> last_ SEGUE_GUARDED_BY(mutex_);
  std::vector<std::pair<std::uint64_t, bool>> decisions_ SEGUE_GUARDED_BY(mutex_);
  bool ended_ SEGUE_GUARDED_BY(mutex_) = false;
};

}  // namespace segue::mission::detail

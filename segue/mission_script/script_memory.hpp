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
  /// An execution that has used the variables of its state. It began with those of the execution `from` (0:
  /// none). `told`: it was told to, so whether that is right shows elsewhere.
  struct Use {
    std::string path;
    std::uint64_t execution = 0;
    std::uint64_t from = 0;
    bool told = false;
  };
  /// Its changes, kept aside.
  static std::shared_ptr<PendingChanges> changes(std::shared_ptr<ScriptMemory> memory, Use use);
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

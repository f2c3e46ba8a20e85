// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

namespace segue {

/// The reads and changes of a run of an action, other than its outputs, while it is not certain that the run
/// counts. The changes are kept aside until then; without apply() they are dropped on destruction. For one
/// thread; no function blocks.
class PendingChanges {
 public:
  PendingChanges() = default;
  virtual ~PendingChanges() = default;
  PendingChanges(const PendingChanges&) = delete;
  PendingChanges& operator=(const PendingChanges&) = delete;

  /// Nothing was read or changed, so the run may count at any time.
  [[nodiscard]] virtual bool empty() const = 0;
  /// Whether only the ends of all actions before tell what the run should have read. If not, its inputs do.
  [[nodiscard]] virtual bool needs_turn() const { return true; }
  /// Whether a run that begins now, when all actions before it have ended, would read the same. Without
  /// needs_turn(): when those have ended from which its inputs come.
  [[nodiscard]] virtual bool valid() const = 0;
  /// Makes the changes. InvalidState, without any change, if an action that comes later has already used
  /// what they change.
  virtual Result<void> apply() = 0;
};

}  // namespace segue

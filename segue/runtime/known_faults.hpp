// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/model/ids.hpp>
#include <segue/runtime/change_count.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/runtime/supervision.hpp>

#include <map>
#include <set>
#include <string>
#include <vector>

namespace segue::runtime::detail {

/// The faults that supervision has found last, for whoever asks. Thread safe; nothing blocks.
class KnownFaults {
 public:
  /// `changes` gets a count where faults change; it must outlive this.
  explicit KnownFaults(ChangeCount& changes) : changes_(changes) {}

  void set_unresolved(std::vector<UnresolvedFault> faults);
  [[nodiscard]] std::vector<UnresolvedFault> unresolved() const;
  /// Faults that are being mended, or will be.
  void set_in_repair(std::vector<UnresolvedFault> faults);
  [[nodiscard]] std::vector<UnresolvedFault> in_repair() const;
  /// The handling of each fault of the running controller so far, by its name.
  void set_handled(std::map<std::string, Handling> handled);
  [[nodiscard]] std::map<std::string, Handling> handled() const;

  void process_ended(const model::DeploymentKey& process, const std::string& why);
  /// Forgets processes that are there again, or no longer wanted.
  void forget_ended_but(const std::set<model::DeploymentKey>& missing);
  /// Processes that ended and are still missing, and why.
  [[nodiscard]] std::map<model::DeploymentKey, std::string> ended() const;

 private:
  void exchange(std::vector<UnresolvedFault>& kept, std::vector<UnresolvedFault> faults)
      SEGUE_REQUIRES(mutex_);

  ChangeCount& changes_;
  mutable Mutex mutex_;  ///< protects all below
  std::vector<UnresolvedFault> unresolved_ SEGUE_GUARDED_BY(mutex_);
  std::vector<UnresolvedFault> in_repair_ SEGUE_GUARDED_BY(mutex_);
  std::map<std::string, Handling> handled_ SEGUE_GUARDED_BY(mutex_);
  std::map<model::DeploymentKey, std::string> ended_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::runtime::detail

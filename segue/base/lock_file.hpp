// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>

#include <filesystem>
#include <optional>
#include <string>

/// Files whose lock (flock) says that what stands beside them belongs to a living process, and that tell
/// which. The lock ends with the last descriptor of its owner, so one that can be had is stale. All functions
/// may be called from any thread.
namespace segue {

/// Who says to hold the lock.
struct LockRecord {
  int pid = 0;  ///< 0: it is still starting
  std::string software;
};

/// "NAME.lock", beside the file that it is for.
std::filesystem::path lock_of(const std::filesystem::path& file);

/// Makes the lock file (mode 0600) where there is none and takes its lock. Nothing where somebody else has
/// it. Does not block.
Result<std::optional<Descriptor>> try_lock(const std::filesystem::path& lock);

/// The same, but waits while the process of its record is ending, at most until `deadline`.
Result<std::optional<Descriptor>> lock_when_ended(const std::filesystem::path& lock, TimePoint deadline);

/// Overwrites the record of a lock; the place of a new one always has room. False where the system does not
/// let it.
bool write_record(int lock, const LockRecord& record);

/// Nothing where there is no lock file or no record in it.
std::optional<LockRecord> read_record(const std::filesystem::path& lock);

}  // namespace segue

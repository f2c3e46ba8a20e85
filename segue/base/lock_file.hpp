// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>

#include <filesystem>
#include <optional>
#include <string>

/// Lock files (flock): a locked file says that the resource beside it belongs to a living process, and its
/// record says to which. The lock ends with the owner's last descriptor, so a lock that can be taken is
/// stale. All functions may be called from any thread.
namespace segue {

/// The process that claims to hold the lock.
struct LockRecord {
  int pid = 0;  ///< 0: still starting
  std::string software;
};

/// "NAME.lock" beside `file`.
std::filesystem::path lock_of(const std::filesystem::path& file);

/// Creates the lock file (mode 0600) if needed and takes its lock; nullopt where another process holds it.
/// Does not block.
Result<std::optional<Descriptor>> try_lock(const std::filesystem::path& lock);

/// Takes the lock like try_lock(), but waits until `deadline` while the process named in its record is
/// ending.
Result<std::optional<Descriptor>> lock_when_ended(const std::filesystem::path& lock, TimePoint deadline);

/// Overwrites the record of a lock. Records have a fixed size, so this works on a full disk, too. False where
/// writing fails.
bool write_record(int lock, const LockRecord& record);

/// Reads the record; nullopt where there is no lock file or no valid record in it.
std::optional<LockRecord> read_record(const std::filesystem::path& lock);

}  // namespace segue

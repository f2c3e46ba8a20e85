// SPDX-License-Identifier: Apache-2.0
#include <segue/base/lock_file.hpp>

#include <segue/base/error.hpp>
#include <segue/base/process_state.hpp>
#include <segue/base/text.hpp>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <string_view>

namespace segue {

namespace {

namespace fs = std::filesystem;

constexpr mode_t kOwnerOnlyLock = 0600;
constexpr int kAttempts = 100;
/// The pause between two checks of a process that is ending.
constexpr auto kPause = std::chrono::milliseconds(1);
/// Records are padded to this size, so that a full disk lets them be overwritten.
constexpr std::size_t kRecordSize = 128;
constexpr std::string_view kPid = "pid ";
constexpr std::string_view kSoftware = "\nsoftware ";

bool is_file_at(int descriptor, const fs::path& path) {
  struct stat mine {};
  struct stat there {};
  return ::fstat(descriptor, &mine) == 0 && ::stat(path.c_str(), &there) == 0 &&
         mine.st_ino == there.st_ino && mine.st_dev == there.st_dev;
}

}  // namespace

fs::path lock_of(const fs::path& file) {
  return fs::path(file) += ".lock";
}

Result<std::optional<Descriptor>> try_lock(const fs::path& lock) {
  // If the last owner removed the file meanwhile, this lock protects nothing: try again.
  for (int i = 0; i < kAttempts; ++i) {
    Descriptor file(::open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, kOwnerOnlyLock));
    if (!file.valid()) return system_error("cannot open the lock " + quote(lock.native()), errno);
    if (::flock(file.get(), LOCK_EX | LOCK_NB) != 0) {
      if (errno == EWOULDBLOCK) return std::optional<Descriptor>{};
      return system_error("cannot lock " + quote(lock.native()), errno);
    }
    if (is_file_at(file.get(), lock)) return std::optional<Descriptor>(std::move(file));
  }
  return fail(ErrorCode::Unavailable,
              "the lock " + quote(lock.native()) + " keeps being removed and created by others");
}

Result<std::optional<Descriptor>> lock_when_ended(const fs::path& lock, TimePoint deadline) {
  for (;;) {
    // Checked before the lock is tried: a process that ends in between has released the lock by then.
    const auto holder = read_record(lock);
    const bool ending = holder && holder->pid != 0 && is_ending(holder->pid);
    auto taken = try_lock(lock);
    if (!taken || taken->has_value() || !ending) return taken;
    const auto now = RealClock::instance().now();
    if (now >= deadline) return taken;
    RealClock::instance().sleep_until(std::min(deadline, now + kPause));
  }
}

/// Format: "pid 12\nsoftware 0.1.0\n", padded with zeros.
bool write_record(int lock, const LockRecord& record) {
  std::string text(kPid);
  text.append(std::to_string(record.pid)).append(kSoftware).append(record.software).append("\n");
  text.resize(kRecordSize, '\0');
  return ::pwrite(lock, text.data(), text.size(), 0) == static_cast<ssize_t>(text.size());
}

std::optional<LockRecord> read_record(const fs::path& lock) {
  const Descriptor file(::open(lock.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  std::array<char, kRecordSize> buffer{};
  const ssize_t size = file.valid() ? ::pread(file.get(), buffer.data(), buffer.size(), 0) : -1;
  std::string_view text(buffer.data(), size < 0 ? 0 : static_cast<std::size_t>(size));
  if (!text.starts_with(kPid)) return std::nullopt;
  text.remove_prefix(kPid.size());
  LockRecord record;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), record.pid);
  if (status != std::errc{} || record.pid < 0) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  if (!text.starts_with(kSoftware)) return std::nullopt;
  text.remove_prefix(kSoftware.size());
  record.software = text.substr(0, std::min(text.find('\n'), text.size()));
  return record;
}

}  // namespace segue

// SPDX-License-Identifier: Apache-2.0
#include <segue/task/futex.hpp>

#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <ctime>

namespace segue::task::detail {

static_assert(sizeof(std::atomic<std::uint32_t>) == sizeof(std::uint32_t));

namespace {
constexpr int flag_of(FutexScope scope) {
  return scope == FutexScope::Process ? FUTEX_PRIVATE_FLAG : 0;
}
}  // namespace

[[gnu::hot]] bool futex_wait(const std::atomic<std::uint32_t>& word, std::uint32_t expected,
                             TimePoint deadline, FutexScope scope) noexcept {
  timespec until{};
  const bool timed = deadline != kNever;
  if (timed) {
    const auto since_boot = std::max(deadline.time_since_epoch(), Duration::zero());
    until.tv_sec = static_cast<time_t>(since_boot.count() / 1'000'000'000);
    until.tv_nsec = static_cast<long>(since_boot.count() % 1'000'000'000);
  }
  // The bitset form takes an absolute time on CLOCK_MONOTONIC, steady_clock's.
  const long result = syscall(SYS_futex, &word, FUTEX_WAIT_BITSET | flag_of(scope), expected,
                              timed ? &until : nullptr, nullptr, FUTEX_BITSET_MATCH_ANY);
  return result == 0 || errno != ETIMEDOUT;
}

[[gnu::hot]] void futex_wake(const std::atomic<std::uint32_t>& word, int count, FutexScope scope) noexcept {
  syscall(SYS_futex, &word, FUTEX_WAKE | flag_of(scope), count, nullptr, nullptr, 0);
}

}  // namespace segue::task::detail

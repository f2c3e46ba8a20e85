// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/base/wait.hpp>
#include <segue/task_host/watches.hpp>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>

namespace segue::runtime::detail {

/// Counts changes of what the robot runs, of its faults, and of who commands it, for those who wait for one.
/// Thread safe.
class ChangeCount {
 public:
  /// Something may have changed, which whoever asks from now on sees. Does not block.
  void add() noexcept;
  [[nodiscard]] std::uint64_t count() const noexcept { return count_.load(std::memory_order_seq_cst); }
  /// As Runtime::watch_changes().
  void watch(std::uint64_t seen, const Wait& wait, std::function<void(Result<std::uint64_t>)> answered);
  /// Ends all waits with an error; later questions are answered at once.
  void close() { watches_.close(); }

 private:
  std::atomic<std::uint64_t> count_{1};
  task_host::detail::Watches watches_{std::chrono::hours(1), "segue-changes"};  ///< every change rings
};

}  // namespace segue::runtime::detail

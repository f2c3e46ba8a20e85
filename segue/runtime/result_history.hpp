// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/runtime/switch_result.hpp>

#include <cstddef>
#include <deque>
#include <string>
#include <vector>

namespace segue::runtime::detail {

/// The results of the last hundred transitions, or fewer where these are large. Thread safe; nothing blocks.
class ResultHistory {
 public:
  /// Keeps about so many bytes at most, but always the last result.
  explicit ResultHistory(std::size_t kept_bytes) : kept_bytes_(kept_bytes) {}

  void add(SwitchResult result);
  /// Oldest first.
  [[nodiscard]] std::vector<SwitchResult> all() const;
  /// The error of the last one; empty: it had none, or there is none.
  [[nodiscard]] std::string last_error() const;

 private:
  const std::size_t kept_bytes_;
  mutable Mutex mutex_;
  std::deque<SwitchResult> results_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::runtime::detail

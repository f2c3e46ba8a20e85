// SPDX-License-Identifier: Apache-2.0
#include <segue/task/wake_batch.hpp>

namespace segue::task::detail {

namespace {
/// The innermost batch of this thread. Reached without a call, as any small variable of a thread should be
/// that every sample passes.
[[gnu::tls_model("initial-exec")]] thread_local WakeBatch* current_batch = nullptr;
}  // namespace

// The entries stay uninitialized up to count_.
// NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init)
[[gnu::hot]] WakeBatch::WakeBatch() noexcept : outer_(current_batch) {
  current_batch = this;
}

[[gnu::hot]] WakeBatch::~WakeBatch() {
  current_batch = outer_;
  for (std::size_t i = 0; i < count_; ++i)
    entries_[i].wake(entries_[i].sleeper);
}

[[gnu::hot]] void WakeBatch::add(Wake wake, void* sleeper) noexcept {
  WakeBatch* const batch = current_batch;
  if (batch == nullptr) return wake(sleeper);
  for (std::size_t i = 0; i < batch->count_; ++i) {
    if (batch->entries_[i].sleeper == sleeper) return;
  }
  if (batch->count_ == kMost) return wake(sleeper);
  batch->entries_[batch->count_++] = {wake, sleeper};
}

}  // namespace segue::task::detail

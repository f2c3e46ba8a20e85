// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>
#include <segue/sample_link/mapping.hpp>
#include <segue/task/commit_gate.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>

namespace segue::sample_link {

/// The page of shared memory by which a runtime commits transitions in all processes of its host at the same
/// instant: one store, which the other processes can read and nobody else can write. It remembers the last
/// kRemembered transitions, so a process that looks late still sees whether its transition has committed. A
/// new runtime makes a new page; an old one never changes again. All functions are thread safe.
class CommitPage : public std::enable_shared_from_this<CommitPage> {
 public:
  static constexpr std::size_t kRemembered = 512;

  /// ResourceExhausted.
  static Result<std::shared_ptr<CommitPage>> create();
  /// The page of another process; the file is untrusted and checked. InvalidArgument.
  static Result<std::shared_ptr<const CommitPage>> map(int descriptor);

  /// Numbers a transition, from 1 on. Only where it was created, as commit().
  std::uint64_t begin() noexcept { return last_.fetch_add(1, std::memory_order_relaxed) + 1; }
  /// Opens every gate that is armed with the number, in all processes.
  void commit(std::uint64_t number) noexcept;
  /// The word to arm a gate with. Keeps the page mapped.
  [[nodiscard]] std::shared_ptr<const task::CommitWord> word(std::uint64_t number) const;
  /// For other processes.
  [[nodiscard]] int descriptor() const noexcept { return file_.descriptor.get(); }

  explicit CommitPage(SealedFile file) : file_(std::move(file)) {}

 private:
  static constexpr std::size_t kSize = kRemembered * sizeof(task::CommitWord);
  static_assert(task::CommitWord::is_always_lock_free);

  [[nodiscard]] task::CommitWord* words() const noexcept {
    return reinterpret_cast<task::CommitWord*>(file_.mapping.data());
  }

  SealedFile file_;
  std::atomic<std::uint64_t> last_{0};  ///< relaxed: numbers differ, and order nothing
};

}  // namespace segue::sample_link

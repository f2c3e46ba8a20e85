// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <utility>

namespace segue::task {

/// The word through which a transition commits: it holds the number of the transition once that has
/// committed. It may lie in memory that another process shares for reading only.
using CommitWord = std::atomic<std::uint64_t>;

/// Gate for connections that begin or end with the commit of a transition. Closed until the transition has
/// committed, then open for ever; a transition that was given up leaves it closed for ever. All ports of a
/// process share the gate of a transition. Any thread; real-time safe but for arm().
///
/// Memory order: whoever sees it open sees everything that came before the commit.
/// - G1: arm() releases number_ and owner_ with word_; armed() and open() acquire it.
/// - G2: the commit releases its word (CommitPage::commit(), LocalTaskHost::commit()); open() acquires it.
class CommitGate {
 public:
  CommitGate() = default;
  CommitGate(const CommitGate&) = delete;
  CommitGate& operator=(const CommitGate&) = delete;

  /// Arms the gate: from now on it is open as soon as `word` holds `number`, which is never 0. To be called
  /// once at most.
  void arm(std::shared_ptr<const CommitWord> word, std::uint64_t number) {
    number_ = number;
    owner_ = std::move(word);
    word_.store(owner_.get(), std::memory_order_release);  // G1
  }
  [[nodiscard]] bool armed() const noexcept { return word_.load(std::memory_order_acquire) != nullptr; }
  [[nodiscard]] bool open() const noexcept {
    const CommitWord* const word = word_.load(std::memory_order_acquire);        // pairs with G1
    return word != nullptr && word->load(std::memory_order_acquire) == number_;  // pairs with G2
  }

 private:
  std::atomic<const CommitWord*> word_{nullptr};  ///< written after the members below
  std::uint64_t number_ = 0;
  std::shared_ptr<const CommitWord> owner_;
};
using CommitGatePtr = std::shared_ptr<const CommitGate>;

}  // namespace segue::task

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <utility>

namespace segue::task_network {

/// Whether an engine is paused, and how many nodes may begin nevertheless. All functions belong to the
/// engine's thread, except ask() and ask_step().
class Pause {
 public:
  /// Requests a pause or its end; one more node. On any thread; heeded by the next take().
  void ask(bool paused) { asked_ = paused; }
  void ask_step() { ++steps_asked_; }

  /// `over`: the run is being stopped, so nothing is held any more.
  void take(bool over) {
    paused_ = asked_ && !over;
    told_ = told_ && paused_;
    const std::uint32_t more = steps_asked_.exchange(0);
    steps_ = paused_ ? steps_ + more : 0;
  }
  [[nodiscard]] bool paused() const { return paused_; }
  /// Whether the next node must wait.
  [[nodiscard]] bool blocks() const { return paused_ && steps_ == 0; }
  /// A node begins; `counts`: it is one of those that are held.
  void begins(bool counts) {
    told_ = false;
    if (counts && steps_ > 0) --steps_;
  }
  /// True once after each begin of a node, to tell that all is held.
  [[nodiscard]] bool tells() { return !std::exchange(told_, true); }

 private:
  bool paused_ = false;
  bool told_ = false;
  std::uint32_t steps_ = 0;
  // Requests, which the next take() reads; they order nothing else.
  std::atomic<bool> asked_{false};
  std::atomic<std::uint32_t> steps_asked_{0};
};

}  // namespace segue::task_network

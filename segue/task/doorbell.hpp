// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

namespace segue::task {

class InputPortBase;

/// What other processes need to wake an executor, in memory that they may write. Whatever they write there
/// can at worst wake it in vain or too late.
struct DoorbellWords {
  static constexpr std::size_t kLeaves = 64;
  static constexpr unsigned kLines = kLeaves * 64;

  /// The lowest two bits say how the executor sleeps, those above count its sleeps, so that a late ring
  /// cannot be mistaken for one of the next sleep.
  alignas(64) std::atomic<std::uint32_t> sleeping{0};
  std::atomic<std::uint32_t> rings{0};  ///< counts rings at an executor that waits for descriptors
  alignas(64) std::atomic<std::uint64_t> summary{0};         ///< which leaves hold bits
  std::array<std::atomic<std::uint64_t>, kLeaves> leaves{};  ///< a bit for each line that was rung
};

/// Rings a line (taken modulo kLines) from any process; real-time safe. Whoever dies inside leaves a doorbell
/// that others can still ring.
void ring(DoorbellWords& words, unsigned line) noexcept;

/// By which other processes tell an executor that samples wait at input ports of its tasks. Each connection
/// has a line. The executor's thread calls what has no other remark.
class Doorbell {
 public:
  enum class Sleep : std::uint8_t { Awake, InFutex, InPoll };

  /// The words must be zero, or those of a doorbell that is gone; the pointer keeps their memory.
  explicit Doorbell(std::shared_ptr<DoorbellWords> words);
  Doorbell(const Doorbell&) = delete;
  Doorbell& operator=(const Doorbell&) = delete;

  /// Any thread: a line for a port; nullopt if all are taken. Allocates.
  std::optional<unsigned> add(InputPortBase& port);
  /// Any thread: the port is not told any more when it returns.
  void remove(unsigned line);
  [[nodiscard]] const std::shared_ptr<DoorbellWords>& words() const { return words_; }

  [[nodiscard]] bool rung() const noexcept { return words_->summary.load(std::memory_order_seq_cst) != 0; }
  /// Tells the ports whose lines were rung. Bounded, whatever the words say.
  void answer() noexcept;
  /// Announces how the thread is going to sleep; rung() must be asked after it.
  void set_sleep(Sleep how) noexcept;
  /// Sleeps as announced (InFutex) until a ring, wake() or `deadline`.
  void wait(TimePoint deadline) const noexcept;
  /// Any thread of this process: ends wait().
  void wake() noexcept;

  /// For a thread that passes rings on to an executor that waits for descriptors: how many there were, and
  /// the next one.
  [[nodiscard]] std::uint32_t rings() const noexcept { return words_->rings.load(std::memory_order_seq_cst); }
  void wait_for_ring(std::uint32_t seen) const noexcept;
  void ring_through() noexcept;

 private:
  const std::shared_ptr<DoorbellWords> words_;
  const std::unique_ptr<std::atomic<InputPortBase*>[]> ports_;
  std::atomic<std::uint64_t> section_{0};  ///< odd: inside answer()
  std::uint32_t announced_ = 0;
  std::uint32_t sleeps_ = 0;
  std::mutex mutex_;
  std::vector<unsigned> free_;  ///< lines that were given back
  unsigned next_ = 0;           ///< the first that was never taken
};

/// For executors: what doorbell() answers where `made` is what its `make` made.
Result<std::shared_ptr<Doorbell>> check_doorbell(std::shared_ptr<Doorbell> made);

}  // namespace segue::task

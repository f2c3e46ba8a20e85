// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace segue::task {

class InputPortBase;

/// The words with which other processes wake an executor, in memory that they can write. Whatever they write
/// there can at worst wake it needlessly or too late.
///
/// Memory order: everything is sequentially consistent but `rung_at`, which is relaxed, since it is a
/// measurement that nothing depends on.
/// - D1: a ringer sets its bits and then loads `sleeping`; the executor stores `sleeping` and then loads
///   `summary`. So either the ringer sees that it must wake the executor, or the executor sees the bits and
///   stays awake. The futex compares `sleeping` when the thread goes to sleep, so a ringer that changes it in
///   between is not missed.
/// - D2: the ringer's bits publish its sample: answer() takes the bit of the summary, then those of the leaf.
///   The ringer sets them in the opposite order, so a bit of the summary comes with that of its leaf.
/// - D3: a ringer, and ring_through(), change `rings` after their reason; the helper thread reads `rings`
///   before it looks for reasons, so the futex does not sleep over one.
struct DoorbellWords {
  static constexpr std::size_t kLeaves = 64;
  static constexpr unsigned kLines = kLeaves * 64;

  /// The lowest two bits say how the executor sleeps (Doorbell::Sleep); the bits above count its sleeps, so
  /// that a ringer delayed since an earlier sleep cannot change the word of a later one.
  alignas(64) std::atomic<std::uint32_t> sleeping{0};
  std::atomic<std::uint32_t> rings{0};   ///< counts rings while the executor waits for descriptors
  std::atomic<std::int64_t> rung_at{0};  ///< monotonic time of the first ring that was not answered; 0: none
  alignas(64) std::atomic<std::uint64_t> summary{0};         ///< the leaves that have bits set
  std::array<std::atomic<std::uint64_t>, kLeaves> leaves{};  ///< one bit for each line, set when it was rung
};

/// Rings a line (taken modulo kLines) from any process; real-time safe. One that sleeps is woken at the end
/// of the caller's detail::WakeBatch, if there is one. A process that dies inside leaves a doorbell that
/// others can still ring.
void ring(DoorbellWords& words, unsigned line) noexcept;

/// The owner's side of a doorbell, with which other processes tell an executor that samples wait at input
/// ports of its tasks. Each connection has a line. Functions without another remark are for the executor's
/// thread.
///
/// Memory order:
/// - D4: add() releases the port of a line; answer() acquires it.
/// - D5: remove() stores nullptr as the port of a line and then loads section_; answer() stores section_ and
///   then loads the port (all sequentially consistent). So either answer() does not find the port, or
///   remove() waits until it has left. Leaving releases section_, and remove() acquires it.
class Doorbell {
 public:
  enum class Sleep : std::uint8_t { Awake, InFutex, InPoll };

  /// `words` must be zero or left over from an earlier doorbell; the pointer keeps their memory alive.
  explicit Doorbell(std::shared_ptr<DoorbellWords> words);
  Doorbell(const Doorbell&) = delete;
  Doorbell& operator=(const Doorbell&) = delete;

  /// A line for a port; nullopt if all are taken. Any thread; allocates.
  std::optional<unsigned> add(InputPortBase& port);
  /// Frees a line. After this has returned, the port is not notified any more. Any thread; waits for
  /// answer().
  void remove(unsigned line);
  /// Waits for the answer() in progress, if any. Any thread but from inside answer().
  void wait_until_answered() const noexcept;
  [[nodiscard]] const std::shared_ptr<DoorbellWords>& words() const { return words_; }

  /// D1: after set_sleep().
  [[nodiscard]] bool rung() const noexcept { return words_->summary.load(std::memory_order_seq_cst) != 0; }
  /// Since when a ring waits for answer(), at most `now`, and an hour ago at the earliest.
  [[nodiscard]] TimePoint rung_since(TimePoint now) noexcept;
  /// Notifies the ports whose lines were rung. Bounded, whatever the words contain.
  void answer() noexcept;
  /// Announces how the thread is going to sleep; rung() must be checked afterwards.
  void set_sleep(Sleep how) noexcept;
  /// Sleeps, announced as InFutex, until a ring, wake() or `deadline`.
  void wait(TimePoint deadline) const noexcept;
  /// Ends wait(). Any thread of this process.
  void wake() noexcept;

  /// For the helper thread of an executor that waits for descriptors: the number of rings so far; wait for
  /// the next one; end that wait.
  [[nodiscard]] std::uint32_t rings() const noexcept { return words_->rings.load(std::memory_order_seq_cst); }
  void wait_for_ring(std::uint32_t seen) const noexcept;
  void ring_through() noexcept;

 private:
  const std::shared_ptr<DoorbellWords> words_;
  const std::unique_ptr<std::atomic<InputPortBase*>[]> ports_;
  std::atomic<std::uint64_t> section_{0};  ///< odd: inside answer(); as in ConnectionList
  std::uint32_t announced_ = 0;
  std::uint32_t sleeps_ = 0;
  Mutex mutex_;                                          ///< guards the members below and changes of ports_
  std::vector<unsigned> free_ SEGUE_GUARDED_BY(mutex_);  ///< lines that were freed
  unsigned next_ SEGUE_GUARDED_BY(mutex_) = 0;           ///< the first line that was never taken
};

/// For executors: `made`, or ResourceExhausted where it is nullptr.
Result<std::shared_ptr<Doorbell>> check_doorbell(std::shared_ptr<Doorbell> made);

}  // namespace segue::task

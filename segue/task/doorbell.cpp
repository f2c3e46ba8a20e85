// SPDX-License-Identifier: Apache-2.0
#include <segue/task/connection_list.hpp>
#include <segue/task/doorbell.hpp>
#include <segue/task/futex.hpp>
#include <segue/task/port_access.hpp>
#include <segue/task/wake_batch.hpp>

#include <algorithm>
#include <bit>

namespace segue::task {

namespace {

using detail::futex_wait;
using detail::futex_wake;
using detail::FutexScope;

constexpr std::uint32_t kModeMask = 3;
constexpr std::uint32_t kWoken = 3;  ///< as mode: InFutex, and a ringer is about to wake it

std::uint64_t bit_of(std::size_t index) {
  return std::uint64_t{1} << (index % 64);
}

/// Takes the lowest bit out of `bits`.
std::size_t take_lowest(std::uint64_t& bits) {
  const auto index = static_cast<std::size_t>(std::countr_zero(bits));
  bits &= bits - 1;
  return index;
}

/// Wakes the thread whose bits were set, if it sleeps. The mode is cleared last, so that later rings need no
/// call of the system; if this process dies before, the next ringer wakes the thread again.
[[gnu::hot]] void wake_sleeper(DoorbellWords& words) noexcept {
  std::uint32_t seen = words.sleeping.load(std::memory_order_seq_cst);  // D1: after the bits were set
  const std::uint32_t mode = seen & kModeMask;
  if (mode == 0) return;
  if (mode == static_cast<std::uint32_t>(Doorbell::Sleep::InPoll)) {
    words.rings.fetch_add(1, std::memory_order_seq_cst);  // D3: after the bits were set
    futex_wake(words.rings, 1, FutexScope::Host);
  } else {
    // Changed first, so that the thread cannot fall asleep after the wake.
    const std::uint32_t woken = seen | kWoken;
    const bool changed = words.sleeping.compare_exchange_strong(seen, woken, std::memory_order_seq_cst);
    if (!changed && seen != woken) return;  // the thread has run since, or another ringer has woken it
    futex_wake(words.sleeping, 1, FutexScope::Host);
    seen = woken;
  }
  words.sleeping.compare_exchange_strong(seen, seen & ~kModeMask, std::memory_order_seq_cst);
}

}  // namespace

[[gnu::hot]] void ring(DoorbellWords& words, unsigned line) noexcept {
  const std::size_t leaf = line / 64 % DoorbellWords::kLeaves;
  if (words.rung_at.load(std::memory_order_relaxed) == 0) {
    words.rung_at.store(monotonic_now().time_since_epoch().count(), std::memory_order_relaxed);
  }
  words.leaves.at(leaf).fetch_or(bit_of(line), std::memory_order_seq_cst);  // D2: before the summary
  words.summary.fetch_or(bit_of(leaf), std::memory_order_seq_cst);          // D1: before `sleeping` is loaded
  detail::WakeBatch::add([](void* rung) noexcept { wake_sleeper(*static_cast<DoorbellWords*>(rung)); },
                         &words);
}

Result<std::shared_ptr<Doorbell>> check_doorbell(std::shared_ptr<Doorbell> made) {
  if (made) return made;
  return fail(ErrorCode::ResourceExhausted,
              "no shared memory is left for waking a thread; give the process a larger control pool");
}

Doorbell::Doorbell(std::shared_ptr<DoorbellWords> words)
    : words_(std::move(words)),
      ports_(std::make_unique<std::atomic<InputPortBase*>[]>(DoorbellWords::kLines)) {}

std::optional<unsigned> Doorbell::add(InputPortBase& port) {
  const Lock lock(mutex_);
  if (free_.empty() && next_ == DoorbellWords::kLines) return std::nullopt;
  unsigned line = next_;
  if (free_.empty()) {
    ++next_;
    free_.reserve(next_);
  } else {
    line = free_.back();
    free_.pop_back();
  }
  ports_[line].store(&port, std::memory_order_release);  // D4
  return line;
}

void Doorbell::remove(unsigned line) {
  const Lock lock(mutex_);
  ports_[line].store(nullptr, std::memory_order_seq_cst);  // D5: before section_ is loaded
  wait_until_answered();
  free_.push_back(line);
}

void Doorbell::wait_until_answered() const noexcept {
  const std::uint64_t seen = section_.load(std::memory_order_seq_cst);  // D5
  if (seen % 2 == 1) detail::wait_until_left(section_, seen);
}

[[gnu::hot]] TimePoint Doorbell::rung_since(TimePoint now) noexcept {
  constexpr Duration kLongest = std::chrono::hours(1);
  const std::int64_t rung_at = words_->rung_at.exchange(0, std::memory_order_relaxed);
  return rung_at == 0 ? now : std::clamp(TimePoint(Duration(rung_at)), now - kLongest, now);
}

[[gnu::hot]] void Doorbell::answer() noexcept {
  const std::uint64_t count = section_.load(std::memory_order_relaxed);
  section_.store(count + 1, std::memory_order_seq_cst);  // D5: before ports are loaded
  std::uint64_t leaves = words_->summary.exchange(0, std::memory_order_seq_cst);  // pairs with D2
  while (leaves != 0) {
    const std::size_t leaf = take_lowest(leaves);
    std::uint64_t lines = words_->leaves.at(leaf).exchange(0, std::memory_order_seq_cst);  // pairs with D2
    while (lines != 0) {
      // D5: after the store of section_. Pairs with D4.
      InputPortBase* port = ports_[leaf * 64 + take_lowest(lines)].load(std::memory_order_seq_cst);
      if (port != nullptr) InputPortAccess::notify(*port);
    }
  }
  section_.store(count + 2, std::memory_order_release);  // D5: remove() acquires it
}

[[gnu::hot]] void Doorbell::set_sleep(Sleep how) noexcept {
  if (how != Sleep::Awake) ++sleeps_;
  announced_ = sleeps_ << 2U | static_cast<std::uint32_t>(how);
  words_->sleeping.store(announced_, std::memory_order_seq_cst);  // D1: before rung() loads the summary
}

[[gnu::hot]] void Doorbell::wait(TimePoint deadline) const noexcept {
  futex_wait(words_->sleeping, announced_, deadline, FutexScope::Host);
}

[[gnu::hot]] void Doorbell::wake() noexcept {
  words_->sleeping.fetch_and(~kModeMask, std::memory_order_seq_cst);  // E1: the futex compares it
  futex_wake(words_->sleeping, 1, FutexScope::Host);
}

void Doorbell::wait_for_ring(std::uint32_t seen) const noexcept {
  futex_wait(words_->rings, seen, detail::kNever, FutexScope::Host);
}

void Doorbell::ring_through() noexcept {
  words_->rings.fetch_add(1, std::memory_order_seq_cst);  // D3: after the reason
  futex_wake(words_->rings, 1, FutexScope::Host);
}

}  // namespace segue::task

// SPDX-License-Identifier: Apache-2.0
#include <segue/sample_link/word_ring.hpp>

#include <algorithm>

namespace segue::sample_link {

namespace {
/// No writer pushes as much between two reads.
constexpr std::uint64_t kMostAhead = std::uint64_t{1} << 48;
}  // namespace

[[gnu::hot]] WordRing::Push WordRing::push(std::uint64_t token, std::uint64_t& before) noexcept {
  const std::uint64_t position = next_;
  std::atomic<Word>& place = word(position);
  // Sequentially consistent for the wake-up protocol, see the class.
  if (kind_ == BufferKind::Buffer) {
    if (place.load(std::memory_order_acquire) != 0) return Push::Refused;  // pairs with R2
    place.store(pack(token, position), std::memory_order_seq_cst);         // R1, R4
    head_->store(++next_, std::memory_order_relaxed);                      // nobody reads it with this policy
    return Push::Taken;
  }
  // R1, R4. Pairs with R2.
  const Word replaced = place.exchange(pack(token, position), std::memory_order_seq_cst);
  // R3: a reader that sees this head sees the word above, so it cannot take the place for empty.
  head_->store(++next_, std::memory_order_release);
  before = replaced >> kPositionBits;
  return replaced == 0 ? Push::Taken : Push::Replaced;
}

[[gnu::hot]] std::uint64_t WordRing::pull() noexcept {
  switch (kind_) {
    case BufferKind::Data:
      return pull_newest();
    case BufferKind::Buffer:
      return pull_next();
    case BufferKind::CircularBuffer:
      return pull_oldest();
  }
  return 0;
}

[[gnu::hot]] std::uint64_t WordRing::pull_newest() noexcept {
  if (word(0).load(std::memory_order_relaxed) == 0) return 0;  // saves the exchange; it decides nothing
  return word(0).exchange(0, std::memory_order_acq_rel) >> kPositionBits;  // R2; pairs with R1
}

[[gnu::hot]] std::uint64_t WordRing::pull_next() noexcept {
  const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
  std::atomic<Word>& place = word(tail);
  const Word found = place.load(std::memory_order_acquire);  // pairs with R1
  if (found == 0) return 0;
  place.store(0, std::memory_order_release);  // R2; only the reader takes out, so without exchange
  tail_.store(tail + 1, std::memory_order_relaxed);
  if (((found ^ tail) & kPositionMask) != 0) {
    note_nonsense();
    return 0;
  }
  return found >> kPositionBits;
}

[[gnu::hot]] std::uint64_t WordRing::read_head() noexcept {
  const std::uint64_t head = head_->load(std::memory_order_acquire);  // pairs with R3
  if (head - seen_head_ < kMostAhead) {
    seen_head_ = head;
  } else {
    note_nonsense();
  }
  return seen_head_;
}

[[gnu::hot]] std::uint64_t WordRing::pull_oldest() noexcept {
  // A writer at full rate overtakes now and then. The limit is for words that no proper writer wrote: they
  // could keep the reader busy for ever.
  const std::size_t most_tries = 2 * size_ + 16;
  std::uint64_t tail = tail_.load(std::memory_order_relaxed);
  for (std::size_t tries = 0; tries < most_tries; ++tries) {
    const std::uint64_t head = read_head();
    if (head > size_) tail = std::max(tail, head - size_);
    std::atomic<Word>& place = word(tail);
    Word found = place.load(std::memory_order_acquire);  // pairs with R1
    if (found == 0) {
      if (tail != tail_.load(std::memory_order_relaxed)) note_nonsense();  // there are older ones at least
      return 0;
    }
    const std::uint64_t ahead = (found - tail) & kPositionMask;
    if (ahead != 0) {
      // Overtaken since head was read: the oldest token left is the one after the last that was overwritten.
      // (Only a multiple of 2^22 pushes since then would go unnoticed.)
      tail += ahead - size_ + 1;
      continue;
    }
    // Fails where the writer has just replaced the word: whoever takes it out owns the token.
    if (!place.compare_exchange_strong(found, 0, std::memory_order_acq_rel)) continue;  // R2; pairs with R1
    ++tail;
    tail_.store(tail, std::memory_order_relaxed);
    return found >> kPositionBits;
  }
  note_nonsense();
  return 0;
}

std::size_t WordRing::count() const noexcept {
  std::size_t count = 0;
  for (std::size_t i = 0; i < size_; ++i)
    count += words_[i].load(std::memory_order_relaxed) != 0 ? 1 : 0;
  return count;
}

bool WordRing::has_hole() const noexcept {
  const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
  return !pending() && count() > 0 && !pending() && tail == tail_.load(std::memory_order_relaxed);
}

bool WordRing::offer(std::uint64_t token) noexcept {
  Word expected = 0;
  return word(0).compare_exchange_strong(expected, pack(token, 0), std::memory_order_seq_cst);  // R1, R4
}

}  // namespace segue::sample_link

// SPDX-License-Identifier: Apache-2.0
#include <segue/link/sample_queue.hpp>

#include <algorithm>

namespace segue::link {

using task::SampleRef;
using task::SampleSlot;

static_assert(alignof(SampleSlot) >= 64, "packed words need six free bits");

SampleQueue::SampleQueue(BufferKind kind, std::size_t size)
    : kind_(kind),
      size_(kind == BufferKind::Data ? 1 : size),
      words_(std::make_unique<std::atomic<Word>[]>(size_)) {}

SampleQueue::~SampleQueue() {
  clear();
}

SampleQueue::Push SampleQueue::push(SampleSlot& sample) noexcept {
  const std::uint64_t position = head_.load(std::memory_order_relaxed);
  std::atomic<Word>& place = word(position);
  // Sequentially consistent, so that either a starting reader finds the sample or the writer finds the reader
  // to be woken.
  if (kind_ == BufferKind::Buffer) {
    if (place.load(std::memory_order_acquire) != 0) return Push::Refused;
    sample.retain();
    place.store(pack(&sample, position), std::memory_order_seq_cst);
    head_.store(position + 1, std::memory_order_relaxed);
    return Push::Taken;
  }
  sample.retain();
  const Word before = place.exchange(pack(&sample, position), std::memory_order_seq_cst);
  head_.store(position + 1, std::memory_order_release);
  if (before == 0) return Push::Taken;
  slot_of(before)->release();
  return Push::Replaced;
}

SampleRef SampleQueue::pull() noexcept {
  switch (kind_) {
    case BufferKind::Data:
      return pull_newest();
    case BufferKind::Buffer:
      return pull_next();
    case BufferKind::CircularBuffer:
      return pull_oldest();
  }
  return {};
}

SampleRef SampleQueue::pull_newest() noexcept {
  if (word(0).load(std::memory_order_relaxed) == 0) return {};
  SampleRef sample = SampleRef::adopt(slot_of(word(0).exchange(0, std::memory_order_acq_rel)));
  // offer_older() may come after a newer sample was read.
  if (!sample || sample->sequence <= newest_read_) return {};
  newest_read_ = sample->sequence;
  return sample;
}

SampleRef SampleQueue::pull_next() noexcept {
  std::atomic<Word>& place = word(tail_);
  const Word found = place.load(std::memory_order_acquire);
  if (found == 0) return {};
  place.store(0, std::memory_order_release);
  ++tail_;
  return SampleRef::adopt(slot_of(found));
}

SampleRef SampleQueue::pull_oldest() noexcept {
  while (true) {
    const std::uint64_t head = head_.load(std::memory_order_acquire);
    if (head > size_) tail_ = std::max(tail_, head - size_);
    std::atomic<Word>& place = word(tail_);
    Word found = place.load(std::memory_order_acquire);
    if (found == 0) return {};
    const std::uint64_t ahead = (found - tail_) & kPositionMask;
    if (ahead != 0) {
      // Overtaken since head was read: the oldest left is the one after what was overwritten last.
      tail_ += ahead - size_ + 1;
      continue;
    }
    if (!place.compare_exchange_strong(found, 0, std::memory_order_acq_rel)) continue;
    ++tail_;
    return SampleRef::adopt(slot_of(found));
  }
}

bool SampleQueue::pending() const noexcept {
  return word(tail_).load(std::memory_order_seq_cst) != 0;
}

bool SampleQueue::offer_older(SampleSlot& sample) noexcept {
  Word expected = 0;
  sample.retain();
  if (word(0).compare_exchange_strong(expected, pack(&sample, 0), std::memory_order_seq_cst)) return true;
  sample.release();
  return false;
}

void SampleQueue::clear() noexcept {
  for (std::size_t i = 0; i < size_; ++i) {
    const Word left = words_[i].exchange(0, std::memory_order_acq_rel);
    if (left != 0) slot_of(left)->release();
  }
}

}  // namespace segue::link

// SPDX-License-Identifier: Apache-2.0
#include <segue/sample_link/sample_queue.hpp>

namespace segue::sample_link {

using task::SampleRef;
using task::SampleSlot;

static_assert(alignof(SampleSlot) >= 64, "packed words need six free bits");

SampleQueue::SampleQueue(BufferKind kind, std::size_t size)
    : kind_(kind),
      words_(std::make_unique<std::atomic<WordRing::Word>[]>(WordRing::places(kind, size))),
      ring_(kind, size, words_.get(), &head_) {}

SampleQueue::~SampleQueue() {
  clear();
}

[[gnu::hot]] SampleQueue::Push SampleQueue::push(SampleSlot& sample) noexcept {
  sample.retain();
  std::uint64_t before = 0;
  const Push pushed = ring_.push(token_of(sample), before);
  if (pushed == Push::Refused) sample.release();
  if (pushed == Push::Replaced) slot_of(before)->release();
  return pushed;
}

[[gnu::hot]] SampleRef SampleQueue::pull() noexcept {
  const std::uint64_t token = ring_.pull();
  if (token == 0) return {};
  SampleRef sample = SampleRef::adopt(slot_of(token));
  if (kind_ != BufferKind::Data) return sample;
  // offer_older() may have put it in after a newer sample was read.
  if (sample->sequence <= newest_read_) return {};
  newest_read_ = sample->sequence;
  return sample;
}

bool SampleQueue::offer_older(SampleSlot& sample) noexcept {
  sample.retain();
  if (ring_.offer(token_of(sample))) return true;
  sample.release();
  return false;
}

void SampleQueue::clear() noexcept {
  for (std::size_t i = 0; i < ring_.places(); ++i) {
    const std::uint64_t left = ring_.remove(i);
    if (left != 0) slot_of(left)->release();
  }
}

}  // namespace segue::sample_link

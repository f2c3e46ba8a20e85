// SPDX-License-Identifier: Apache-2.0
#include <segue/sample_link/sample_queue.hpp>
#include <segue/task/sample_pool.hpp>
#include <segue/type/describe.hpp>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <atomic>
#include <deque>
#include <thread>
#include <vector>

namespace segue::sample_link {
namespace {

using task::SamplePool;
using task::SampleRef;
using task::SampleSlot;

/// A reference model of the queue, as simple as possible.
struct Model {
  BufferKind kind;
  std::size_t size;
  std::deque<std::uint64_t> waiting;

  SampleQueue::Push push(std::uint64_t value) {
    if (waiting.size() < size) {
      waiting.push_back(value);
      return SampleQueue::Push::Taken;
    }
    if (kind == BufferKind::Buffer) return SampleQueue::Push::Refused;
    waiting.pop_front();
    waiting.push_back(value);
    return SampleQueue::Push::Replaced;
  }
};

class Fixture {
 public:
  explicit Fixture(std::size_t slots) { pool->reserve(slots); }

  SampleSlot* write(std::uint64_t value) {
    SampleSlot* slot = pool->acquire();
    if (slot == nullptr) return nullptr;
    *static_cast<std::uint64_t*>(slot->value) = value;
    slot->sequence = value;
    return slot;
  }
  static std::uint64_t value_of(const SampleRef& sample) {
    return *static_cast<const std::uint64_t*>(sample->value);
  }
  std::size_t free_slots() {
    std::vector<SampleRef> all;
    while (SampleSlot* slot = pool->acquire())
      all.push_back(SampleRef::adopt(slot));
    return all.size();
  }
  SamplePool::Handle pool = SamplePool::create(&type::type_info<std::uint64_t>());
};

RC_GTEST_PROP(SampleQueue, BehavesAsItsModel, ()) {
  const auto kind = *rc::gen::element(BufferKind::Data, BufferKind::Buffer, BufferKind::CircularBuffer);
  const auto size = kind == BufferKind::Data ? 1 : *rc::gen::inRange<std::size_t>(1, 9);
  const auto pushes = *rc::gen::container<std::vector<bool>>(rc::gen::arbitrary<bool>());
  Fixture fixture(size + 2);
  {
    SampleQueue queue(kind, size);
    Model model{kind, size, {}};
    std::uint64_t next = 1;
    for (const bool is_push : pushes) {
      RC_ASSERT(queue.pending() == !model.waiting.empty());
      if (is_push) {
        SampleSlot* slot = fixture.write(next);
        RC_ASSERT(slot != nullptr);
        RC_ASSERT(queue.push(*slot) == model.push(next++));
        slot->release();
        continue;
      }
      const SampleRef got = queue.pull();
      RC_ASSERT(static_cast<bool>(got) == !model.waiting.empty());
      if (!got) continue;
      RC_ASSERT(Fixture::value_of(got) == model.waiting.front());
      model.waiting.pop_front();
    }
  }
  RC_ASSERT(fixture.free_slots() == size + 2);
}

/// Both ends at full rate: samples arrive in order, once and intact.
class Concurrent : public ::testing::TestWithParam<std::pair<BufferKind, std::size_t>> {};

TEST_P(Concurrent, SamplesArriveInOrderAndOnceAndAreAllAccountedFor) {
  const auto [kind, size] = GetParam();
  constexpr std::uint64_t kSamples = 100'000;
  Fixture fixture(size + 3);
  SampleQueue queue(kind, size);
  std::atomic<bool> done{false};
  std::uint64_t taken = 0;
  std::uint64_t replaced = 0;
  std::thread writer([&] {
    for (std::uint64_t value = 1; value <= kSamples; ++value) {
      SampleSlot* slot = fixture.write(value);
      ASSERT_NE(slot, nullptr) << "the pool is large enough by construction";
      const SampleQueue::Push pushed = queue.push(*slot);
      slot->release();
      if (pushed != SampleQueue::Push::Refused) ++taken;
      if (pushed == SampleQueue::Push::Replaced) ++replaced;
    }
    done = true;
  });
  std::uint64_t last = 0;
  std::uint64_t read = 0;
  while (true) {
    const bool was_done = done;
    const SampleRef got = queue.pull();
    if (got) {
      const std::uint64_t value = Fixture::value_of(got);
      ASSERT_GT(value, last);
      last = value;
      ++read;
    } else if (was_done) {
      break;
    }
  }
  writer.join();
  EXPECT_EQ(taken, read + replaced);
  if (kind != BufferKind::Buffer) {
    EXPECT_EQ(last, kSamples) << "the newest is never lost";
  }
  EXPECT_EQ(fixture.free_slots(), size + 3);
}

INSTANTIATE_TEST_SUITE_P(Policies, Concurrent,
                         ::testing::Values(std::pair{BufferKind::Data, std::size_t{1}},
                                           std::pair{BufferKind::Buffer, std::size_t{1}},
                                           std::pair{BufferKind::Buffer, std::size_t{7}},
                                           std::pair{BufferKind::CircularBuffer, std::size_t{1}},
                                           std::pair{BufferKind::CircularBuffer, std::size_t{3}},
                                           std::pair{BufferKind::CircularBuffer, std::size_t{64}}));

TEST(SampleQueue, OlderSampleIsOnlyTakenWhereNoNewerOneCame) {
  Fixture fixture(4);
  SampleSlot* older = fixture.write(1);
  SampleSlot* newer = fixture.write(2);
  SampleQueue queue(BufferKind::Data, 1);
  EXPECT_TRUE(queue.offer_older(*older));
  EXPECT_EQ(Fixture::value_of(queue.pull()), 1U);
  queue.push(*newer);
  EXPECT_FALSE(queue.offer_older(*older));
  EXPECT_EQ(Fixture::value_of(queue.pull()), 2U);
  EXPECT_TRUE(queue.offer_older(*older));
  EXPECT_FALSE(queue.pull()) << "older than what was read";
  EXPECT_TRUE(queue.offer_older(*newer));
  EXPECT_FALSE(queue.pull()) << "what was read";
  older->release();
  newer->release();
}

TEST(SamplePool, OutlivesItsPortWhileASampleIsHeld) {
  SampleRef held;
  {
    Fixture fixture(2);
    SampleSlot* slot = fixture.write(7);
    held = SampleRef::share(*slot);
    slot->release();
  }
  EXPECT_EQ(Fixture::value_of(held), 7U);
}

}  // namespace
}  // namespace segue::sample_link

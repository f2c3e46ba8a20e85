// SPDX-License-Identifier: Apache-2.0
#include <segue/sample_link/block_pool.hpp>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <map>
#include <thread>
#include <vector>

namespace segue::sample_link {
namespace {

std::size_t block_size(std::size_t size) {
  return std::max(BlockPool::kUnit, std::bit_ceil(size));
}

RC_GTEST_PROP(BlockPool, BlocksAreAlignedAndNeverOverlap, ()) {
  constexpr std::size_t kSize = 1 << 20;
  const auto pool = *BlockPool::create(kSize, 0);
  std::map<std::uint64_t, std::size_t> blocks;
  std::size_t used = 0;
  const auto steps = *rc::gen::container<std::vector<std::uint32_t>>(rc::gen::arbitrary<std::uint32_t>());
  for (const std::uint32_t step : steps) {
    if (step % 3 == 0 && !blocks.empty()) {
      const auto gone = std::next(blocks.begin(), static_cast<std::ptrdiff_t>(step / 3 % blocks.size()));
      used -= block_size(gone->second);
      pool->release(gone->first);
      blocks.erase(gone);
      continue;
    }
    const std::size_t size = std::size_t{1} << (step / 3 % 19);
    const std::uint64_t offset = pool->allocate(size);
    if (offset == BlockPool::kNone) continue;
    RC_ASSERT(offset % std::min(block_size(size), std::size_t{1} << 16) == 0U);
    RC_ASSERT(offset + block_size(size) <= kSize);
    const auto after = blocks.upper_bound(offset);
    RC_ASSERT((after == blocks.end() || offset + block_size(size) <= after->first));
    RC_ASSERT((after == blocks.begin() ||
               std::prev(after)->first + block_size(std::prev(after)->second) <= offset));
    blocks.emplace(offset, size);
    used += block_size(size);
    RC_ASSERT(pool->used() == used);
  }
}

TEST(BlockPool, ServesUntilItIsFullAndAgainAfterwards) {
  const auto pool = *BlockPool::create(1 << 20, 1 << 20);
  for (int round = 0; round < 3; ++round) {
    std::vector<std::uint64_t> blocks;
    for (std::uint64_t block = pool->allocate(100); block != BlockPool::kNone; block = pool->allocate(100))
      blocks.push_back(block);
    EXPECT_EQ(blocks.size(), (1U << 20) / 128);
    EXPECT_EQ(pool->used(), 1U << 20);
    for (const std::uint64_t block : blocks)
      pool->release(block);
    EXPECT_EQ(pool->used(), 0U);
  }
  EXPECT_EQ(pool->allocate((1 << 20) + 1), BlockPool::kNone);
}

TEST(BlockPool, BlockStaysUntilItsLastReference) {
  const auto pool = *BlockPool::create(1 << 16, 0);
  const std::uint64_t block = pool->allocate(1 << 16);
  ASSERT_NE(block, BlockPool::kNone);
  pool->retain(block);
  pool->release(block);
  EXPECT_EQ(pool->allocate(64), BlockPool::kNone);
  pool->release(block);
  EXPECT_EQ(pool->allocate(1 << 16), block);
}

TEST(BlockPool, ManyThreadsNeverGetTheSameBlock) {
  constexpr std::size_t kSize = 1 << 20;
  const auto pool = *BlockPool::create(kSize, 0);
  std::vector<std::atomic<int>> owners(kSize / BlockPool::kUnit);
  std::atomic<int> shared{0};
  const auto work = [&](unsigned seed) {
    std::vector<std::uint64_t> mine;
    for (int i = 0; i < 20'000; ++i) {
      seed = seed * 1664525 + 1013904223;
      if (mine.size() > 20 || (seed >> 16U) % 2 == 0) {
        if (mine.empty()) continue;
        --owners[mine.back() / BlockPool::kUnit];
        pool->release(mine.back());
        mine.pop_back();
        continue;
      }
      const std::uint64_t block = pool->allocate(std::size_t{64} << ((seed >> 20U) % 6));
      if (block == BlockPool::kNone) continue;
      if (++owners[block / BlockPool::kUnit] != 1) ++shared;
      mine.push_back(block);
    }
    for (const std::uint64_t block : mine) {
      --owners[block / BlockPool::kUnit];
      pool->release(block);
    }
  };
  std::vector<std::thread> threads;
  for (unsigned i = 0; i < 4; ++i)
    threads.emplace_back(work, i + 1);
  for (std::thread& thread : threads)
    thread.join();
  EXPECT_EQ(shared, 0);
  EXPECT_EQ(pool->used(), 0U);
}

}  // namespace
}  // namespace segue::sample_link

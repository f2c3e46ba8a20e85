// SPDX-License-Identifier: Apache-2.0
#include "wire/frame_queue.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

namespace segue::wire {
namespace {

using namespace std::chrono_literals;

Frame numbered(std::uint32_t number) {
  Frame frame(4);
  for (std::size_t i = 0; i < 4; ++i)
    frame[i] = static_cast<std::byte>(number >> (8 * i));
  return frame;
}

std::uint32_t number_of(const Frame& frame) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < 4; ++i)
    number |= std::to_integer<std::uint32_t>(frame[i]) << (8 * i);
  return number;
}

/// Two stations; station 0 sends a frame each microsecond.
struct Stream {
  FrameQueue queue;
  std::vector<std::uint32_t> arrived;
  std::vector<Time> when;
  Time now{};

  explicit Stream(const Impairment& impairment, std::uint64_t seed = 7) : queue(2, seed) {
    queue.impairment(0, 1) = impairment;
  }
  void send(std::uint32_t count) {
    for (std::uint32_t i = 0; i < count; ++i, now += 1us)
      queue.send(0, 1, numbered(i), now);
  }
  void receive_all() {
    while (const auto next = queue.next()) {
      auto arrival = queue.receive(*next);
      arrived.push_back(number_of(arrival->frame));
      when.push_back(*next);
      queue.recycle(std::move(arrival->frame));
    }
  }
  bool in_order() const { return std::is_sorted(arrived.begin(), arrived.end()); }
};

TEST(FrameQueue, DeliversEverythingAtOnceAndInOrderWithoutImpairments) {
  Stream stream({});
  stream.send(1000);
  stream.receive_all();
  ASSERT_EQ(stream.arrived.size(), 1000u);
  EXPECT_TRUE(stream.in_order());
  EXPECT_EQ(stream.when[500], 500us);
}

TEST(FrameQueue, DeliversNothingBeforeTheDelayIsOver) {
  Stream stream({.delay = 20ms});
  stream.send(1);
  EXPECT_FALSE(stream.queue.receive(20ms - 1ns));
  EXPECT_EQ(stream.queue.next(), 20ms);
  EXPECT_TRUE(stream.queue.receive(20ms));
  EXPECT_FALSE(stream.queue.next());
}

TEST(FrameQueue, KeepsTheOrderOfFramesWithTheSameDelay) {
  Stream stream({.delay = 1ms});
  stream.send(1000);
  stream.receive_all();
  EXPECT_TRUE(stream.in_order());
}

TEST(FrameQueue, DelaysByTheJitterAtTheMostAndReorders) {
  Stream stream({.delay = 1ms, .jitter = 50us});
  stream.send(1000);
  stream.receive_all();
  ASSERT_EQ(stream.arrived.size(), 1000u);
  EXPECT_FALSE(stream.in_order());
  for (std::size_t i = 0; i < 1000; ++i) {
    const Time taken = stream.when[i] - stream.arrived[i] * 1us;
    EXPECT_GE(taken, 1ms);
    EXPECT_LE(taken, 1ms + 50us);
  }
}

TEST(FrameQueue, LosesItsShare) {
  Stream stream({.loss = 0.1});
  stream.send(10000);
  stream.receive_all();
  EXPECT_NEAR(static_cast<double>(stream.arrived.size()), 9000, 300);
  EXPECT_EQ(stream.queue.count(0, 1).lost, 10000 - stream.arrived.size());
  EXPECT_TRUE(stream.in_order());
}

TEST(FrameQueue, DuplicatesItsShare) {
  Stream stream({.duplication = 0.1});
  stream.send(10000);
  stream.receive_all();
  EXPECT_NEAR(static_cast<double>(stream.arrived.size()), 11000, 300);
  EXPECT_EQ(std::set<std::uint32_t>(stream.arrived.begin(), stream.arrived.end()).size(), 10000u);
  EXPECT_EQ(stream.queue.count(0, 1).duplicated, stream.arrived.size() - 10000);
}

TEST(FrameQueue, HoldsItsShareBack) {
  Stream stream({.reordering = 0.25, .held_back = 10us});
  stream.send(10000);
  stream.receive_all();
  ASSERT_EQ(stream.arrived.size(), 10000u);
  EXPECT_FALSE(stream.in_order());
  EXPECT_NEAR(static_cast<double>(stream.queue.count(0, 1).held_back), 2500, 250);
}

TEST(FrameQueue, CutsOneDirectionOnly) {
  FrameQueue queue(2, 1);
  queue.impairment(0, 1).cut = true;
  queue.send(0, 1, numbered(1), 0ns);
  queue.send(1, 0, numbered(2), 0ns);
  const auto arrival = queue.receive(0ns);
  ASSERT_TRUE(arrival);
  EXPECT_EQ(arrival->to, 0u);
  EXPECT_FALSE(queue.next());
}

TEST(FrameQueue, CarriesNewFramesAsItsNewImpairmentsSay) {
  Stream stream({.cut = true});
  stream.send(10);
  stream.queue.impairment(0, 1) = {};
  stream.send(10);
  stream.receive_all();
  EXPECT_EQ(stream.arrived.size(), 10u);
}

TEST(FrameQueue, LosesAndCountsWhatItCannotHold) {
  Stream stream({.delay = 1s});
  stream.send(FrameQueue::kCapacity + 5);
  EXPECT_EQ(stream.queue.count(0, 1).overflowed, 5u);
  stream.receive_all();
  EXPECT_EQ(stream.arrived.size(), FrameQueue::kCapacity);
  stream.send(1);
  EXPECT_EQ(stream.queue.count(0, 1).overflowed, 5u);
}

TEST(FrameQueue, DoesTheSameWithTheSameSeed) {
  const auto arrivals = [](std::uint64_t seed) {
    Stream stream({.jitter = 100us, .loss = 0.1, .duplication = 0.1}, seed);
    stream.send(1000);
    stream.receive_all();
    return stream.arrived;
  };
  EXPECT_EQ(arrivals(1), arrivals(1));
  EXPECT_NE(arrivals(1), arrivals(2));
}

TEST(FrameQueue, AccountsForEveryFrame) {
  Stream stream(
      {.delay = 1ms, .jitter = 1ms, .loss = 0.1, .duplication = 0.2, .reordering = 0.1, .held_back = 1ms});
  stream.send(5000);
  stream.receive_all();
  const Count& count = stream.queue.count(0, 1);
  EXPECT_EQ(count.sent, 5000u);
  EXPECT_EQ(count.sent + count.duplicated, count.delivered + count.lost + count.overflowed);
  EXPECT_EQ(count.delivered, stream.arrived.size());
}

}  // namespace
}  // namespace segue::wire

// SPDX-License-Identifier: Apache-2.0
#include <segue/task/timer_heap.hpp>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <array>
#include <optional>

namespace segue::task::detail {
namespace {

class TestTimer final : public Timer {};

constexpr std::size_t kTimers = 40;

/// Which timers are set, and when they are due.
using Model = std::array<std::optional<TimePoint>, kTimers>;

TimePoint first_of(const Model& model) {
  TimePoint first = kNever;
  for (const auto& due : model) {
    if (due) first = std::min(first, *due);
  }
  return first;
}

RC_GTEST_PROP(TimerHeap, AlwaysKnowsTheFirst, ()) {
  std::array<TestTimer, kTimers> timers;
  Model model;
  TimerHeap heap;
  const auto steps = *rc::gen::container<std::vector<std::pair<std::size_t, int>>>(
      rc::gen::pair(rc::gen::inRange<std::size_t>(0, kTimers), rc::gen::inRange(-15, 50)));
  for (const auto& [index, due] : steps) {
    if (due < 0) {
      heap.clear(timers.at(index));
      model.at(index).reset();
    } else {
      model.at(index) = TimePoint(Duration(due));
      heap.set(timers.at(index), *model.at(index));
    }
    RC_ASSERT(heap.next_due() == first_of(model));
  }
  while (heap.first() != nullptr) {
    RC_ASSERT(heap.next_due() == first_of(model));
    Timer& first = *heap.first();
    const auto index = static_cast<std::size_t>(static_cast<TestTimer*>(&first) - timers.data());
    RC_ASSERT(model.at(index) == first.due());
    heap.clear(first);
    model.at(index).reset();
  }
  RC_ASSERT(first_of(model) == kNever);
}

TEST(TimerHeap, TakesManyInAnyOrder) {
  std::vector<TestTimer> timers(100'000);
  TimerHeap heap;
  for (std::size_t i = 0; i < timers.size(); ++i)
    heap.set(timers[i], TimePoint(Duration(i)));  // the worst order for a tree that is not balanced
  for (std::size_t i = 0; i < timers.size(); i += 2)
    heap.clear(timers[i]);
  for (std::size_t i = 1; i < timers.size(); i += 2) {
    ASSERT_EQ(heap.next_due(), TimePoint(Duration(i)));
    heap.clear(*heap.first());
  }
  EXPECT_EQ(heap.first(), nullptr);
}

}  // namespace
}  // namespace segue::task::detail

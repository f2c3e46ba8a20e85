// SPDX-License-Identifier: Apache-2.0
#include <segue/concurrent/thread_pool.hpp>

#include <gmock/gmock.h>

#include <atomic>
#include <csignal>
#include <future>
#include <latch>

namespace segue::concurrent {
namespace {

using namespace std::chrono_literals;

TimePoint in(Duration time) {
  return RealClock::instance().now() + time;
}

constexpr auto kLong = 30s;

TEST(ThreadPool, RunsEveryJobAndWaitsForThemAtItsEnd) {
  std::atomic<int> sum{0};
  ThreadPool pool("test", {2, 1});
  for (int i = 0; i < 100; ++i) {
    EXPECT_TRUE(pool.submit([&] { ++sum; }));
  }
  pool.close();
  EXPECT_EQ(sum, 100);
  EXPECT_FALSE(pool.submit([&] { ++sum; }));
  EXPECT_EQ(sum, 100);
}

TEST(ThreadPool, JobsWaitBeyondTheLimitUnlessTheyMustBeginAtOnce) {
  ThreadPool pool("test", {1, 1});
  std::promise<void> release;
  std::atomic<bool> waited{false};
  EXPECT_TRUE(pool.try_submit([&] { release.get_future().wait(); }));
  EXPECT_FALSE(pool.try_submit([] {}));
  EXPECT_TRUE(pool.submit([&] { waited = true; }));
  EXPECT_FALSE(waited);
  release.set_value();
  pool.close();
  EXPECT_TRUE(waited);
}

TEST(ThreadPool, RunsAllAtTheSameTime) {
  ThreadPool pool("test", {8, 1});
  std::latch all(4);
  pool.run_all({4, [&] { all.arrive_and_wait(); }});
  EXPECT_TRUE(all.try_wait());
}

TEST(ThreadPool, RunsAllInsideAJobAndAfterItsEnd) {
  ThreadPool pool("test", {1, 1});
  std::atomic<int> sum{0};
  const auto add = [&] { ++sum; };
  EXPECT_TRUE(pool.run([&] { pool.run_all({3, add}); }, in(kLong)));
  EXPECT_EQ(sum, 3);
  pool.close();
  pool.run_all({3, add});
  EXPECT_EQ(sum, 6);
  EXPECT_EQ(pool.run(add, in(kLong)).error().code, ErrorCode::Unavailable);
}

TEST(ThreadPool, AnOverdueJobKeepsItsThreadWhichAnotherOneReplaces) {
  ThreadPool pool("test", {1, 1});
  std::promise<void> release;
  const auto overdue = pool.run([waits = release.get_future().share()] { waits.wait(); }, in(10ms));
  ASSERT_FALSE(overdue);
  EXPECT_EQ(overdue.error().code, ErrorCode::DeadlineExceeded);
  EXPECT_TRUE(pool.run([] {}, in(kLong)));
  release.set_value();
  pool.close();
}

TEST(ThreadPool, SignalsAreBlockedInItsThreads) {
  ThreadPool pool("test", {1, 1});
  sigset_t blocked{};
  ASSERT_TRUE(pool.run([&] { ::pthread_sigmask(SIG_BLOCK, nullptr, &blocked); }, in(kLong)));
  EXPECT_EQ(sigismember(&blocked, SIGTERM), 1);
  EXPECT_EQ(sigismember(&blocked, SIGSEGV), 0);
}

class Counter final : public DeadlineWatch::Entry {
 public:
  TimePoint on_due(TimePoint now) override {
    if (++calls == 3) {
      done.set_value();
      return TimePoint::max();
    }
    return now + 1ms;
  }
  std::atomic<int> calls{0};
  std::promise<void> done;
};

TEST(DeadlineWatch, CallsAnEntryWheneverItIsDue) {
  DeadlineWatch watch;
  const auto often = std::make_shared<Counter>();
  const auto removed = std::make_shared<Counter>();
  watch.add(removed, in(1ms + kLong));
  watch.add(often, in(-1s));
  watch.remove(removed);
  EXPECT_EQ(often->done.get_future().wait_for(kLong), std::future_status::ready);
  watch.close();
  EXPECT_EQ(often->calls, 3);
  EXPECT_EQ(removed->calls, 0);
}

}  // namespace
}  // namespace segue::concurrent

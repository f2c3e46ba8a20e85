// SPDX-License-Identifier: Apache-2.0
// How sleeping threads are woken: in batches, by doorbells, or not at all because they spin.
#include <segue/task/doorbell.hpp>
#include <segue/task/executor_set.hpp>
#include <segue/task/probe_component.hpp>
#include <segue/task/thread_executor.hpp>
#include <segue/task/wake_batch.hpp>

#include <gmock/gmock.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <memory>
#include <semaphore>
#include <string>
#include <thread>
#include <vector>

namespace segue::task {
namespace {

using namespace std::chrono_literals;
using test::soon;
using ::testing::Each;
using ::testing::HasSubstr;

void count_wake(void* sleeper) noexcept {
  ++*static_cast<int*>(sleeper);
}

TEST(WakeBatch, WakesEachSleeperOnceAtItsEnd) {
  std::array<int, 2> wakes{};
  {
    const detail::WakeBatch batch;
    for (int i = 0; i < 3; ++i) {
      for (int& sleeper : wakes)
        detail::WakeBatch::add(count_wake, &sleeper);
    }
    EXPECT_THAT(wakes, Each(0));
  }
  EXPECT_THAT(wakes, Each(1));
}

TEST(WakeBatch, WakesAtOnceWhereThereIsNone) {
  int wakes = 0;
  detail::WakeBatch::add(count_wake, &wakes);
  EXPECT_EQ(wakes, 1);
}

TEST(WakeBatch, LeavesOutNobodyWhereSleepersAreMany) {
  std::array<int, 100> wakes{};
  {
    const detail::WakeBatch batch;
    for (int& sleeper : wakes)
      detail::WakeBatch::add(count_wake, &sleeper);
  }
  EXPECT_THAT(wakes, Each(1));
}

TEST(WakeBatch, InsideAnotherEndsByItself) {
  int wakes = 0;
  const detail::WakeBatch outer;
  {
    const detail::WakeBatch inner;
    detail::WakeBatch::add(count_wake, &wakes);
  }
  EXPECT_EQ(wakes, 1);
}

class Ringing : public ::testing::Test {
 protected:
  [[nodiscard]] auto mode() const { return static_cast<Doorbell::Sleep>(words->sleeping.load() & 3U); }

  std::shared_ptr<DoorbellWords> words = std::make_shared<DoorbellWords>();
  Doorbell doorbell{words};
};

TEST_F(Ringing, FirstRingWakesSoThatTheNextOnesNeedNoCall) {
  for (const auto how : {Doorbell::Sleep::InFutex, Doorbell::Sleep::InPoll}) {
    doorbell.set_sleep(how);
    ring(*words, 7);
    EXPECT_EQ(mode(), Doorbell::Sleep::Awake);
  }
}

TEST_F(Ringing, LinesOfABatchWakeOnceAtItsEnd) {
  doorbell.set_sleep(Doorbell::Sleep::InFutex);
  {
    const detail::WakeBatch batch;
    ring(*words, 1);
    ring(*words, 70);
    EXPECT_EQ(mode(), Doorbell::Sleep::InFutex);
    EXPECT_TRUE(doorbell.rung());
  }
  EXPECT_EQ(mode(), Doorbell::Sleep::Awake);
  EXPECT_EQ(words->summary.load(), 3U);
}

TEST_F(Ringing, SleeperThatARingerLeftWhenItDiedIsWokenByTheNextRing) {
  doorbell.set_sleep(Doorbell::Sleep::InFutex);
  words->sleeping.fetch_or(3U);  // as a ringer does before it wakes the thread
  ring(*words, 7);
  EXPECT_EQ(mode(), Doorbell::Sleep::Awake);
}

/// A task that tells of each update. Its thread sleeps at once, spins for so short that it often is about to
/// fall asleep, or for so long that it seldom does.
class Spinning : public ::testing::TestWithParam<Duration> {
 protected:
  void start(Activity activity) {
    activity.spin = GetParam();
    auto component = std::make_unique<test::Probe>();
    probe = component.get();
    probe->act = [this](const std::string& hook) -> Result<void> {
      if (hook == "start" && event >= 0) return probe->trigger_fd(event);
      if (hook != "update") return {};
      probe->hooks.clear();
      eventfd_t value = 0;
      if (event >= 0) eventfd_read(event, &value);
      updated.release();
      return {};
    };
    auto made = Task::create("spinning", std::move(component), &activity);
    ASSERT_TRUE(made) << to_string(made.error());
    task = std::move(*made);
    ASSERT_TRUE(task->configure(soon()));
    ASSERT_TRUE(task->start(soon()));
  }

  int event = -1;
  std::counting_semaphore<> updated{0};
  std::unique_ptr<Task> task;
  test::Probe* probe = nullptr;
};

TEST_P(Spinning, NoTriggerIsLost) {
  start({.trigger = Trigger::PortDriven});
  for (int i = 0; i < 1000; ++i) {
    InputPortAccess::notify(probe->input);
    updated.acquire();
  }
  EXPECT_TRUE(task->stop(soon()));
}

TEST_P(Spinning, PeriodIsKept) {
  start({.trigger = Trigger::Periodic, .period = 20ms});
  for (int i = 0; i < 5; ++i)
    updated.acquire();
  EXPECT_TRUE(task->stop(soon()));
}

TEST_P(Spinning, DescriptorsAreSeen) {
  event = eventfd(0, EFD_NONBLOCK);
  start(fd_driven());
  for (int i = 0; i < 100; ++i) {
    eventfd_write(event, 1);
    updated.acquire();
  }
  EXPECT_TRUE(task->stop(soon()));
  task.reset();
  close(event);
}

TEST_P(Spinning, RingsOfOtherProcessesAreAnswered) {
  start({.trigger = Trigger::PortDriven});
  // Makes the doorbell that a connection between processes makes.
  Activity activity{.thread = "ringing"};
  activity.spin = GetParam();
  auto executor = ExecutorSet::of_process().executor_for("ringing", activity);
  ASSERT_TRUE(executor);
  auto words = std::make_shared<DoorbellWords>();
  auto doorbell = (*executor)->doorbell([&] { return std::make_shared<Doorbell>(words); });
  ASSERT_TRUE(doorbell);
  const auto line = (*doorbell)->add(probe->input);
  ASSERT_TRUE(line);
  for (int i = 0; i < 1000; ++i) {
    ring(*words, *line);
    updated.acquire();
  }
  (*doorbell)->remove(*line);
  EXPECT_TRUE(task->stop(soon()));
}

INSTANTIATE_TEST_SUITE_P(For, Spinning, ::testing::Values(0us, 2us, 100us));

TEST(Spin, LongerThanTheLongestIsRefused) {
  Activity activity;
  for (const Duration spin : {Duration(kLongestSpin) + 1ns, Duration(-1)}) {
    activity.spin = spin;
    auto made = ThreadExecutor::create("x", activity);
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().code, ErrorCode::InvalidArgument);
    EXPECT_THAT(made.error().message, HasSubstr("spins for at most 10ms"));
  }
}

TEST(Spin, IsOneForAllOfAThreadGroup) {
  ExecutorSet set;
  Activity spins{.thread = "g"};
  spins.spin = 50us;
  auto first = set.executor_for("a", spins);
  ASSERT_TRUE(first);
  auto second = set.executor_for("b", {.thread = "g"});
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, HasSubstr("already runs as normal that spins for 50us"));
}

}  // namespace
}  // namespace segue::task

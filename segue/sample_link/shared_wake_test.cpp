// SPDX-License-Identifier: Apache-2.0
#include <segue/base/virtual_clock.hpp>
#include <segue/sample_link/local.hpp>
#include <segue/sample_link/shared_test_support.hpp>
#include <segue/task/manual_executor.hpp>
#include <segue/task/thread_executor.hpp>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <unistd.h>

#include <deque>
#include <functional>
#include <latch>
#include <memory>
#include <string>
#include <vector>

namespace segue::sample_link {
namespace {

using namespace shared_test;
using Text = std::vector<std::string>;

TEST(SharedConnection, ReaderIsWokenByTheWriter) {
  Pair pair;
  Source<Pose> source;
  auto [task, counter] = running<Counter>("counter", {});
  Link link = pair.connect(source.out, counter->in, {BufferKind::Buffer, 4});
  ASSERT_TRUE(link.ok);
  for (int i = 1; i <= 5000; ++i) {
    source.out.write(Pose(i));
    ASSERT_TRUE(eventually([&, seen = counter] { return seen->last == i; })) << i;
  }
  EXPECT_TRUE(task->stop(soon()));
  // A connection from before the start wakes the task as well.
  source.out.write(Pose(2000));
  EXPECT_TRUE(task->start(soon()));
  EXPECT_TRUE(eventually([seen = counter] { return seen->last == 2000; }));
  source.out.write(Pose(2001));
  EXPECT_TRUE(eventually([seen = counter] { return seen->last == 2001; }));
}

/// Driven by an event that never happens: its thread waits for descriptors.
struct Waiting : Component {
  Descriptor never{eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)};

 protected:
  Result<void> on_start() override { return trigger_fd(never.get()); }
};

/// Keeps its thread busy.
struct Blocker : Component {
  InputPort<int> in{*this, "in"};
  std::latch inside{1};
  std::latch go_on{1};

 protected:
  void on_update() override {
    in.drain();
    inside.count_down();
    go_on.wait();
  }
};

TEST(SharedConnection, LatencyCountsFromTheWriteInTheOtherProcess) {
  constexpr auto kBusy = std::chrono::milliseconds(5);
  Pair pair;
  Source<Pose> source;
  Source<int> start;
  const Activity shared{.trigger = Trigger::PortDriven, .thread = "latency"};
  auto [blocking, blocker] = running<Blocker>("blocker", shared);
  auto [counting, counter] = running<Counter>("counter", shared);
  ASSERT_TRUE(pair.connect(source.out, counter->in, {BufferKind::Buffer, 4}).ok);
  ASSERT_TRUE(connect(start.out, blocker->in, {}));
  start.out.write(1);
  blocker->inside.wait();
  source.out.write(Pose(1));
  std::this_thread::sleep_for(kBusy);  // what is tested is that time is measured where it passes
  blocker->go_on.count_down();
  ASSERT_TRUE(eventually([&, &seen = *counter] { return seen.updates > 0; }));
  ASSERT_TRUE(counting->stop(soon()));
  EXPECT_GE(counting->timing().latency_worst, kBusy);
  EXPECT_LT(counting->timing().latency_worst, std::chrono::minutes(1));
}

TEST(SharedConnection, ThreadThatWaitsForDescriptorsIsWokenToo) {
  for (const bool polls_first : {true, false}) {
    Pair pair;
    Source<Pose> source;
    const std::string group = polls_first ? "polls-first" : "polls-later";
    auto [task, counter] = running<Counter>("counter", {.thread = group});
    std::unique_ptr<Task> waiting;
    const auto start_waiting = [&] {
      waiting =
          running<Waiting>("waiting", {.trigger = Trigger::FileDescriptorDriven, .thread = group}).first;
    };
    if (polls_first) start_waiting();
    ASSERT_TRUE(pair.connect(source.out, counter->in, {BufferKind::Buffer, 4}).ok);
    if (!polls_first) start_waiting();
    for (int i = 1; i <= 300; ++i) {
      source.out.write(Pose(i));
      ASSERT_TRUE(eventually([&, seen = counter] { return seen->last == i; })) << i;
    }
  }
}

TEST(SharedConnection, TaskThatMovedToAnotherThreadIsWokenThere) {
  Pair pair;
  Source<Pose> source;
  auto [task, counter] = running<Counter>("counter", {});
  ASSERT_TRUE(pair.connect(source.out, counter->in, {BufferKind::Buffer, 4}).ok);
  source.out.write(Pose(1));
  ASSERT_TRUE(eventually([seen = counter] { return seen->last == 1; }));
  ASSERT_TRUE(task->stop(soon()));
  ASSERT_TRUE(task->cleanup(soon()));
  auto executor = task::ThreadExecutor::create("other", {});
  ASSERT_TRUE(executor);
  auto renewed = Task::renew(*task, {}, *executor, soon());
  ASSERT_TRUE(renewed);
  task.reset();
  ASSERT_TRUE((*renewed)->configure(soon()));
  ASSERT_TRUE((*renewed)->start(soon()));
  for (int i = 2; i < 100; ++i) {
    source.out.write(Pose(i));
    ASSERT_TRUE(eventually([seen = counter, i] { return seen->last == i; })) << i;
  }
}

TEST(SharedConnection, PeriodicTaskIsNotWokenBySamples) {
  Pair pair;
  Source<Pose> source;
  auto [task, counter] =
      running<Counter>("counter", {.trigger = Trigger::Periodic, .period = std::chrono::hours(1)});
  ASSERT_TRUE(pair.connect(source.out, counter->in, {}).ok);
  ASSERT_TRUE(eventually([seen = counter] { return seen->updates == 1; }));
  const MemoryUsage usage = pair.reader->usage();
  for (int i = 0; i < 100; ++i)
    source.out.write(Pose(i));
  EXPECT_EQ(counter->updates, 1U);
  EXPECT_EQ(pair.reader->usage().control_used, usage.control_used) << "it has no doorbell at all";
}

TEST(SharedConnection, ManualExecutorAnswersWhenItRuns) {
  Pair pair;
  Source<Pose> source;
  VirtualClock clock;
  auto executor = std::make_shared<task::ManualExecutor>(clock);
  auto component = std::make_unique<Counter>();
  Counter* counter = component.get();
  auto made = Task::create("counter", std::move(component), {}, executor);
  ASSERT_TRUE(made);
  ASSERT_TRUE((*made)->configure(soon()));
  ASSERT_TRUE((*made)->start(soon()));
  ASSERT_TRUE(pair.connect(source.out, counter->in, {}).ok);
  source.out.write(Pose(1));
  EXPECT_EQ(counter->last, 0);
  executor->run_ready();
  EXPECT_EQ(counter->last, 1);
}

}  // namespace
}  // namespace segue::sample_link

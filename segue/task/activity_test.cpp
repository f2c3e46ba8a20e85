// SPDX-License-Identifier: Apache-2.0
#include <segue/task/executor_set.hpp>
#include <segue/task/probe_component.hpp>
#include <segue/task/thread_executor.hpp>

#include <gmock/gmock.h>
#include <pthread.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <latch>
#include <semaphore>
#include <thread>

namespace segue::task {
namespace {

using namespace std::chrono_literals;
using test::soon;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Periodic : public test::TaskTest {
 protected:
  Periodic() {
    make({.trigger = Trigger::Periodic, .period = 10ms});
    bring_to(TaskState::Running);
  }
};

TEST_F(Periodic, UpdatesAtOnceAndThenEveryPeriod) {
  executor->run_ready();
  EXPECT_EQ(probe->hooks.size(), 1U);
  executor->advance(99ms);
  EXPECT_EQ(probe->hooks.size(), 10U);
  executor->advance(1ms);
  EXPECT_EQ(probe->hooks.size(), 11U);
  EXPECT_EQ(task->timing().missed, 0U);
  EXPECT_EQ(task->timing().jitter, Duration::zero());
}

TEST_F(Periodic, MissedCyclesAreCountedAndNotMadeUpFor) {
  executor->run_ready();
  clock.advance(35ms);  // the updates at 10, 20 and 30 ms were missed
  executor->run_ready();
  EXPECT_EQ(probe->hooks.size(), 2U);
  EXPECT_EQ(task->timing().missed, 2U);
  EXPECT_EQ(task->timing().latency_worst, 25ms);
  executor->advance(5ms);
  EXPECT_EQ(probe->hooks.size(), 3U) << "the next is due at 40, as it always was";
}

TEST_F(Periodic, UpdateThatTakesLongIsMeasured) {
  probe->act = [this](const std::string& hook) -> Result<void> {
    if (hook == "update") clock.advance(4ms);
    return {};
  };
  executor->advance(20ms);
  EXPECT_EQ(task->timing().last, 4ms);
  EXPECT_EQ(task->timing().worst, 4ms);
  EXPECT_EQ(task->timing().mean, 4ms);
}

TEST_F(Periodic, UpdatesAreCountedByTheirDurationsAndLatencies) {
  probe->act = [this](const std::string& hook) -> Result<void> {
    if (hook == "update") clock.advance(4ms);
    return {};
  };
  executor->advance(20ms);
  clock.advance(12ms);
  executor->run_ready();
  const auto cycles = task->timing().cycles;
  const auto histograms = task->timing_histograms();
  EXPECT_EQ(histograms.updates.counts[DurationHistogram::bin_of(4ms)], cycles);
  EXPECT_EQ(histograms.updates.total(), cycles);
  EXPECT_EQ(histograms.latencies.total(), cycles);
  EXPECT_EQ(histograms.latencies.counts[DurationHistogram::bin_of(task->timing().latency_worst)], 1U);
  ASSERT_TRUE(task->stop(soon()));
  ASSERT_TRUE(task->start(soon()));
  EXPECT_EQ(task->timing_histograms(), TimingHistograms{}) << "timing begins with the start";
}

TEST_F(Periodic, StopsAndStartsAnewInPhaseWithTheStart) {
  executor->advance(25ms);
  ASSERT_TRUE(task->stop(soon()));
  executor->advance(100ms);
  EXPECT_EQ(probe->hooks.size(), 4U);
  probe->hooks.clear();
  ASSERT_TRUE(task->start(soon()));
  executor->advance(10ms);
  EXPECT_THAT(probe->hooks, ElementsAre("start", "update", "update"));
  EXPECT_EQ(task->timing().cycles, 2U) << "timing begins with the start";
}

TEST(UpdateDeadline, IsTheDeclaredOneOrDependsOnThePeriod) {
  EXPECT_EQ(deadline_of({.trigger = Trigger::Periodic, .period = 10ms}), 5s);
  EXPECT_EQ(deadline_of({.trigger = Trigger::Periodic, .period = 2s}), 20s);
  EXPECT_EQ(deadline_of({.trigger = Trigger::Periodic, .period = 1000h}), 24h);
  EXPECT_EQ(deadline_of({.trigger = Trigger::PortDriven}), 30s);
  EXPECT_EQ(deadline_of({.trigger = Trigger::Periodic, .period = 10ms, .update_deadline = 7ms}), 7ms);
}

class OverdueUpdate : public test::TaskTest {
 protected:
  OverdueUpdate() {
    make({.trigger = Trigger::Periodic, .period = 10ms, .update_deadline = 20ms});
    bring_to(TaskState::Running);
  }
};

TEST_F(OverdueUpdate, IsReportedAndItsMissedCyclesAreCountedWhileItRuns) {
  probe->act = [this](const std::string& hook) -> Result<void> {
    if (hook != "update" || probe->hooks.size() > 1) return {};
    EXPECT_EQ(task->timing().missed, 0U);
    clock.advance(19ms);
    EXPECT_EQ(task->timing().missed, 0U) << "the update that is due at 10 can still begin late";
    EXPECT_FALSE(task->overdue());
    clock.advance(1ms);
    EXPECT_EQ(task->timing().missed, 1U);
    EXPECT_EQ(task->overdue(), "on_update has not returned within 20ms");
    return {};
  };
  executor->run_ready();
  EXPECT_FALSE(task->overdue());
  executor->run_ready();
  EXPECT_EQ(probe->hooks.size(), 2U);
  EXPECT_EQ(task->timing().missed, 1U) << "as it was counted before";
}

TEST_F(OverdueUpdate, KeepsNoVerbWaiting) {
  std::binary_semaphore inside(0);
  std::binary_semaphore release(0);
  probe->act = [&](const std::string& hook) -> Result<void> {
    if (hook != "update" || probe->hooks.size() > 1) return {};
    clock.advance(20ms);
    inside.release();
    release.acquire();
    return {};
  };
  std::thread updating([&] { executor->run_ready(); });
  inside.acquire();
  const auto stopped = task->stop(TimePoint::max() - 1ns);
  EXPECT_THAT(to_string(stopped.error()),
              HasSubstr("cannot stop now: on_update has not returned within 20ms"));
  EXPECT_FALSE(task->set_properties(type::Value::map({{"gain", 2.0}}), soon()));
  EXPECT_EQ(task->state(), TaskState::Running);
  release.release();
  updating.join();
  EXPECT_FALSE(task->overdue());
  EXPECT_TRUE(task->stop(soon()));
}

TEST_F(OverdueUpdate, OfAnErrorIsNamedAsSuch) {
  probe->act = [this](const std::string& hook) -> Result<void> {
    if (hook == "update") probe->error(probe->too_hot, "too hot");
    if (hook != "error") return {};
    clock.advance(20ms);
    EXPECT_EQ(task->overdue(), "on_error has not returned within 20ms");
    return {};
  };
  executor->run_ready();
  executor->advance(10ms);
  EXPECT_THAT(probe->hooks, ::testing::Contains("error"));
}

using PortDriven = test::TaskTest;

struct Choosy : test::Probe {
  InputPort<int> other{*this, "other"};
  Choosy() : Probe({.trigger_on = {"other"}}) {}
};

class TriggerPorts : public PortDriven {
 protected:
  /// The hooks that run because a sample has arrived at `input`, where the activity names `ports`.
  std::vector<std::string> hooks_after(InputPort<int> Choosy::*input, std::set<std::string> ports) {
    auto component = std::make_unique<Choosy>();
    Choosy* choosy = component.get();
    auto made =
        Task::create("choosy", std::move(component), Activity{.triggers = std::move(ports)}, executor);
    if (!made || !(*made)->configure(soon()) || !(*made)->start(soon())) return {"did not start"};
    choosy->hooks.clear();
    InputPortAccess::notify(choosy->*input);
    executor->run_ready();
    return choosy->hooks;
  }
};

TEST_F(TriggerPorts, OfTheComponentTriggerAlone) {
  EXPECT_THAT(hooks_after(&Choosy::other, {}), ElementsAre("update"));
}

TEST_F(TriggerPorts, OtherInputsTriggerNothing) {
  EXPECT_TRUE(hooks_after(static_cast<InputPort<int> Choosy::*>(&Choosy::input), {}).empty());
}

TEST_F(TriggerPorts, OfTheActivityTakeThePlaceOfTheComponents) {
  const auto input = static_cast<InputPort<int> Choosy::*>(&Choosy::input);
  EXPECT_THAT(hooks_after(input, {"input"}), ElementsAre("update"));
  EXPECT_TRUE(hooks_after(&Choosy::other, {"input"}).empty());
}

TEST_F(PortDriven, DoesNotStartWithoutTheInputThatTriggersIt) {
  auto made = Task::create("choosy", std::make_unique<Choosy>(), Activity{.triggers = {"othr"}}, executor);
  ASSERT_TRUE(made);
  ASSERT_TRUE((*made)->configure(soon()));
  const auto started = (*made)->start(soon());
  ASSERT_FALSE(started);
  EXPECT_THAT(started.error().message,
              HasSubstr("no input port 'othr' to trigger the task, did you mean 'other'?"));
}

class Threads : public ::testing::Test {
 protected:
  struct Made {
    std::unique_ptr<Task> task;
    test::Probe* probe = nullptr;
  };
  static Made make(const std::string& id, const Activity& activity) {
    auto component = std::make_unique<test::Probe>();
    Made made{nullptr, component.get()};
    auto task = Task::create(id, std::move(component), &activity);
    EXPECT_TRUE(task) << to_string(task.error());
    if (task) made.task = std::move(*task);
    return made;
  }
};

TEST_F(Threads, PeriodicTaskUpdatesOnItsOwnNamedThread) {
  Made made = make("a_rather_long_name", {.trigger = Trigger::Periodic, .period = 1ms});
  std::latch updates(5);
  std::string thread_name;
  int count = 0;
  made.probe->act = [&](const std::string& hook) -> Result<void> {
    if (hook != "update" || ++count > 5) return {};
    std::array<char, 16> name{};
    pthread_getname_np(pthread_self(), name.data(), name.size());
    thread_name = name.data();
    updates.count_down();
    return {};
  };
  ASSERT_TRUE(made.task->configure(soon()));
  ASSERT_TRUE(made.task->start(soon()));
  updates.wait();
  ASSERT_TRUE(made.task->stop(soon()));
  EXPECT_EQ(thread_name, "a_rather_long_n");
  EXPECT_GE(made.task->timing().cycles, 5U);
}

TEST_F(Threads, VerbThatTimesOutLeavesTheTaskAndWorksLater) {
  Made made = make("slow", {});
  std::latch inside(1);
  std::latch go_on(1);
  made.probe->act = [&](const std::string& hook) -> Result<void> {
    if (hook != "update") return {};
    inside.count_down();
    go_on.wait();
    return {};
  };
  ASSERT_TRUE(made.task->configure(soon()));
  ASSERT_TRUE(made.task->start(soon()));
  InputPortAccess::notify(made.probe->input);
  inside.wait();
  const Result<void> stopped = made.task->stop(RealClock::instance().now() + 1ms);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().code, ErrorCode::DeadlineExceeded);
  EXPECT_EQ(made.task->state(), TaskState::Running);
  go_on.count_down();
  EXPECT_TRUE(made.task->stop(soon()));
}

TEST_F(Threads, StopWaitsForTheUpdateInProgress) {
  Made made = make("slow", {});
  std::latch inside(1);
  std::latch go_on(1);
  made.probe->act = [&](const std::string& hook) -> Result<void> {
    if (hook == "update") {
      inside.count_down();
      go_on.wait();
    }
    return {};
  };
  ASSERT_TRUE(made.task->configure(soon()));
  ASSERT_TRUE(made.task->start(soon()));
  InputPortAccess::notify(made.probe->input);
  inside.wait();
  std::thread stopper([&] { EXPECT_TRUE(made.task->stop(soon())); });
  go_on.count_down();
  stopper.join();
  EXPECT_THAT(made.probe->hooks, ElementsAre("configure", "start", "update", "stop"));
}

TEST_F(Threads, GroupSharesOneThreadAndEndsWithItsLastTask) {
  const Activity grouped{.thread = "shared"};
  Made first = make("first", grouped);
  Made second = make("second", grouped);
  std::atomic<pthread_t> one{};
  std::atomic<pthread_t> two{};
  std::latch updated(2);
  const auto note = [&](std::atomic<pthread_t>& where) {
    return [&](const std::string& hook) -> Result<void> {
      if (hook == "update") {
        where = pthread_self();
        updated.count_down();
      }
      return {};
    };
  };
  first.probe->act = note(one);
  second.probe->act = note(two);
  for (Made* made : {&first, &second}) {
    ASSERT_TRUE(made->task->configure(soon()));
    ASSERT_TRUE(made->task->start(soon()));
    InputPortAccess::notify(made->probe->input);
  }
  updated.wait();
  EXPECT_EQ(one.load(), two.load());
  first.task.reset();
  std::latch again(1);
  second.probe->act = [&](const std::string& hook) -> Result<void> {
    if (hook == "update") again.count_down();
    return {};
  };
  InputPortAccess::notify(second.probe->input);
  again.wait();
}

TEST_F(Threads, TaskMayBeDestroyedByAnotherOfItsGroup) {
  const Activity grouped{.thread = "reaper"};
  Made victim = make("victim", grouped);
  ASSERT_TRUE(victim.task->configure(soon()));
  ASSERT_TRUE(victim.task->start(soon()));
  Made reaper = make("reaper", grouped);
  std::latch reaped(1);
  reaper.probe->act = [&](const std::string& hook) -> Result<void> {
    if (hook != "update") return {};
    InputPortAccess::notify(victim.probe->input);
    victim.task.reset();
    reaped.count_down();
    return {};
  };
  ASSERT_TRUE(reaper.task->configure(soon()));
  ASSERT_TRUE(reaper.task->start(soon()));
  InputPortAccess::notify(reaper.probe->input);
  reaped.wait();
  EXPECT_TRUE(reaper.task->stop(soon()));
}

TEST_F(Threads, GroupWithContradictingSettingsIsRefused) {
  ExecutorSet set;
  auto first = set.executor_for("a", {.cpus = {0}, .thread = "g"});
  ASSERT_TRUE(first);
  auto second = set.executor_for("b", {.thread = "g"});
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, HasSubstr("thread group 'g' already runs as normal on cpus 0"));
  first->reset();
  EXPECT_TRUE(set.executor_for("b", {.thread = "g"})) << "a group that is gone binds nobody";
}

TEST_F(Threads, PriorityOutOfRangeIsRefusedWithARemedy) {
  auto made = ThreadExecutor::create("x", {.scheduler = Scheduler::Fifo, .priority = 0});
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error().message, HasSubstr("from 1 to 99"));
}

TEST_F(Threads, SchedulerIsGrantedOrRefusedWithARemedyOrOptional) {
  const Activity fifo{.scheduler = Scheduler::Fifo, .priority = 10};
  auto made = ThreadExecutor::create("x", fifo);
  Activity optional = fifo;
  optional.optional = true;
  auto lenient = ThreadExecutor::create("x", optional);
  ASSERT_TRUE(lenient);
  EXPECT_EQ((*lenient)->scheduler_granted(), made.has_value());
  if (made) return;
  EXPECT_EQ(made.error().code, ErrorCode::PermissionDenied);
  EXPECT_THAT(made.error().message, HasSubstr("CAP_SYS_NICE"));
}

TEST_F(Threads, ProcessorThatIsNotThereIsRefused) {
  auto made = ThreadExecutor::create("x", {.cpus = {1000}});
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::InvalidArgument);
}

}  // namespace
}  // namespace segue::task

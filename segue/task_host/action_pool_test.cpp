// SPDX-License-Identifier: Apache-2.0
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/task_host/action_pool.hpp>
#include <segue/task_host/batch_outcomes.hpp>
#include <segue/task_host/test_support.hpp>

#include <gmock/gmock.h>

#include <atomic>
#include <map>
#include <set>
#include <stdexcept>
#include <thread>

namespace segue::task_host {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::on_connection;
using testing::on_task;
using ::testing::SizeIs;
using testing::soon;
using namespace std::chrono_literals;

/// Collects the reports of batches; knows whether two calls overlapped.
class Reports {
 public:
  Completion listener() {
    return [this](std::vector<Completed> ended) {
      const bool alone = !inside_.exchange(true);
      Lock lock(mutex_);
      overlapped_ = overlapped_ || !alone;
      ++calls_;
      for (auto& one : ended) {
        twice_ = twice_ || outcomes_.contains(one.index);
        outcomes_.insert_or_assign(one.index, std::move(one.outcome));
      }
      inside_ = false;
      changed_.notify_all();
    };
  }
  bool wait_for(std::size_t count) {
    Lock lock(mutex_);
    return changed_.wait_until(mutex_, soon(), [&] { return outcomes_.size() >= count; });
  }
  bool has(std::size_t index) {
    const Lock lock(mutex_);
    return outcomes_.contains(index);
  }
  Result<void> at(std::size_t index) {
    const Lock lock(mutex_);
    return outcomes_.at(index);
  }
  std::size_t count() {
    const Lock lock(mutex_);
    return outcomes_.size();
  }
  std::size_t calls() {
    const Lock lock(mutex_);
    return calls_;
  }
  bool orderly() {
    const Lock lock(mutex_);
    return !twice_ && !overlapped_;
  }

 private:
  std::atomic<bool> inside_{false};
  Mutex mutex_;
  ConditionVariable changed_;
  std::map<std::size_t, Result<void>> outcomes_;
  std::size_t calls_ = 0;
  bool twice_ = false;
  bool overlapped_ = false;
};

/// Does "slow..." when it is let go, fails at "bad...", throws at "throws...".
class Worker {
 public:
  ~Worker() { release(); }
  ActionPool::Work work() {
    return [this](const model::Action& action, TimePoint /*deadline*/) { return act(*action.task()); };
  }
  void release() {
    const Lock lock(mutex_);
    released_ = true;
    changed_.notify_all();
  }
  std::vector<std::string> begun() {
    const Lock lock(mutex_);
    return begun_;
  }
  std::set<std::thread::id> threads() {
    const Lock lock(mutex_);
    return threads_;
  }

 private:
  Result<void> act(const model::TaskId& task) {
    Lock lock(mutex_);
    begun_.push_back(task.str());
    threads_.insert(std::this_thread::get_id());
    if (task.str().starts_with("slow")) {
      changed_.wait(mutex_, [&] { return released_; });
    }
    if (task.str().starts_with("throws")) {
      throw std::runtime_error("a defect");
    }
    if (task.str().starts_with("bad")) {
      return fail(ErrorCode::HookFailed, "it is bad");
    }
    return {};
  }

  Mutex mutex_;
  ConditionVariable changed_;
  bool released_ = false;
  std::vector<std::string> begun_;
  std::set<std::thread::id> threads_;
};

std::vector<model::Action> stops(const std::vector<std::string>& tasks) {
  std::vector<model::Action> actions;
  for (const auto& task : tasks) {
    actions.push_back(on_task(model::ActionKind::Stop, task));
  }
  return actions;
}

TimePoint in(Duration time) {
  return RealClock::instance().now() + time;
}

/// Begins a batch and waits until all of it has been reported.
void run(ActionPool& pool, const std::vector<model::Action>& actions, TimePoint deadline,
         const Completion& completed, bool here = false) {
  wait_for_outcomes(actions.size(), [&](const Completion& done) {
    const Completion both = [&completed, done](const std::vector<Completed>& ended) {
      completed(ended);
      done(ended);
    };
    here ? pool.begin_here(actions, deadline, both) : pool.begin(actions, deadline, both);
  });
}

class ActionPoolTest : public ::testing::Test {
 protected:
  ~ActionPoolTest() override {
    worker_.release();
    pool_.close();
    EXPECT_TRUE(reported_.orderly()) << "each action once, one call at a time";
  }

  Worker worker_;
  Reports reported_;
  concurrent::ThreadPool threads_{"test", kActionThreads};
  ActionPool pool_{threads_, worker_.work()};
};

TEST_F(ActionPoolTest, TellsOfEveryActionBeforeItReturns) {
  run(pool_, stops({"a", "bad", "c"}), soon(), reported_.listener());
  ASSERT_EQ(reported_.count(), 3U);
  EXPECT_TRUE(reported_.at(0));
  EXPECT_EQ(reported_.at(1).error().code, ErrorCode::HookFailed);
  EXPECT_TRUE(reported_.at(2)) << "a failure in the middle keeps nobody from being done";
}

TEST_F(ActionPoolTest, HasNothingToTellOfAnEmptyBatch) {
  pool_.begin_here({}, soon(), reported_.listener());
  pool_.begin({}, soon(), reported_.listener());
  EXPECT_EQ(reported_.calls(), 0U);
}

TEST_F(ActionPoolTest, CarriesOutWhatItIsGivenInTheCallersThreadWhereThatIsWanted) {
  // Of several, a worker helps with those that have to wait.
  run(pool_, stops({"a"}), soon(), reported_.listener(), true);
  EXPECT_EQ(reported_.count(), 1U);
  EXPECT_TRUE(worker_.threads().contains(std::this_thread::get_id()));
}

TEST_F(ActionPoolTest, ASlowActionHoldsUpNoOther) {
  pool_.begin(stops({"a", "slow", "b", "slow2", "c"}), soon(), reported_.listener());
  ASSERT_TRUE(reported_.wait_for(3)) << "reported while the slow ones are still at it";
  EXPECT_FALSE(reported_.has(1));
  EXPECT_FALSE(reported_.has(3));
  worker_.release();
  ASSERT_TRUE(reported_.wait_for(5));
}

TEST_F(ActionPoolTest, TheCallersThreadBeingSlowHoldsUpNoOther) {
  std::thread caller([&] { run(pool_, stops({"slow", "a", "b"}), soon(), reported_.listener(), true); });
  EXPECT_TRUE(reported_.wait_for(2));
  EXPECT_FALSE(reported_.has(0));
  worker_.release();
  caller.join();
  EXPECT_EQ(reported_.count(), 3U);
}

TEST_F(ActionPoolTest, GivesUpWhatHangsAtTheDeadline) {
  run(pool_, stops({"a", "slow", "b"}), in(2s), reported_.listener());
  ASSERT_EQ(reported_.count(), 3U);
  EXPECT_TRUE(reported_.at(0));
  EXPECT_TRUE(reported_.at(2));
  ASSERT_FALSE(reported_.at(1));
  EXPECT_EQ(reported_.at(1).error().code, ErrorCode::DeadlineExceeded);
  EXPECT_THAT(to_string(reported_.at(1).error()), HasSubstr("stop slow"));
  worker_.release();
  pool_.close();
  EXPECT_EQ(reported_.count(), 3U) << "what returns too late is not reported";
  EXPECT_FALSE(reported_.at(1));
}

TEST_F(ActionPoolTest, GivesUpASingleActionThatHangs) {
  run(pool_, stops({"slow"}), in(50ms), reported_.listener());
  EXPECT_EQ(reported_.at(0).error().code, ErrorCode::DeadlineExceeded);
}

TEST_F(ActionPoolTest, ADeadlineThatHasPassedIsReportedEvenSo) {
  run(pool_, stops({"slow", "slow2", "slow3"}), in(-1s), reported_.listener());
  EXPECT_EQ(reported_.count(), 3U);
}

TEST_F(ActionPoolTest, AnExceptionIsAFailureOfItsActionOnly) {
  run(pool_, stops({"throws", "a"}), soon(), reported_.listener());
  EXPECT_EQ(reported_.at(0).error().code, ErrorCode::Internal);
  EXPECT_THAT(reported_.at(0).error().message, HasSubstr("a defect"));
  EXPECT_TRUE(reported_.at(1));
}

TEST_F(ActionPoolTest, ManyThatHangLeaveAllOthersDone) {
  std::vector<std::string> tasks;
  for (int i = 0; i < 100; ++i) {
    tasks.push_back((i % 2 == 0 ? "slow" : "quick") + std::to_string(i));
  }
  pool_.begin(stops(tasks), soon(), reported_.listener());
  EXPECT_TRUE(reported_.wait_for(50));
  worker_.release();
  EXPECT_TRUE(reported_.wait_for(100));
}

TEST_F(ActionPoolTest, BatchesAreCarriedOutSideBySide) {
  pool_.begin(stops({"slow"}), soon(), reported_.listener());
  Reports other;
  run(pool_, stops({"a", "b"}), soon(), other.listener());
  EXPECT_EQ(other.count(), 2U);
  EXPECT_EQ(reported_.count(), 0U);
  worker_.release();
  EXPECT_TRUE(reported_.wait_for(1));
}

TEST_F(ActionPoolTest, ManyCallersAtOnceAreAllReported) {
  std::vector<std::thread> callers;
  std::atomic<std::size_t> sum{0};
  for (int i = 0; i < 8; ++i) {
    callers.emplace_back([&, i] {
      for (int round = 0; round < 50; ++round) {
        const auto actions = stops({"a", "bad", "b", "c"});
        const Completion count = [&](const std::vector<Completed>& ended) { sum += ended.size(); };
        i % 2 == 0 ? run(pool_, actions, soon(), count) : run(pool_, actions, soon(), count, true);
      }
    });
  }
  for (auto& caller : callers) {
    caller.join();
  }
  EXPECT_EQ(sum, 8U * 50U * 4U);
}

TEST_F(ActionPoolTest, BeginsNothingAfterItsEnd) {
  pool_.close();
  run(pool_, stops({"a", "b"}), soon(), reported_.listener());
  EXPECT_EQ(reported_.at(0).error().code, ErrorCode::Unavailable);
  EXPECT_EQ(reported_.at(1).error().subject, "stop b");
  EXPECT_THAT(worker_.begun(), IsEmpty());
}

TEST_F(ActionPoolTest, ABatchThatAReportBeginsFollowsOnTheSameThread) {
  Reports next;
  pool_.begin(stops({"a"}), soon(),
              [&](const std::vector<Completed>&) { pool_.begin(stops({"b"}), soon(), next.listener()); });
  EXPECT_TRUE(next.wait_for(1));
  EXPECT_THAT(worker_.begun(), ElementsAre("a", "b"));
  EXPECT_THAT(worker_.threads(), SizeIs(1));
}

TEST_F(ActionPoolTest, ABatchThatFollowsDoesNotWaitForAReportThatBlocks) {
  pool_.begin(stops({"a"}), soon(), [&](const std::vector<Completed>&) {
    pool_.begin(stops({"b"}), soon(), reported_.listener());
    EXPECT_TRUE(reported_.wait_for(1)) << "another thread has taken it";
  });
  EXPECT_TRUE(reported_.wait_for(1));
}

TEST_F(ActionPoolTest, ThreadsOfOverdueActionsAreReplaced) {
  concurrent::ThreadPool one("test", {1, 1});
  ActionPool pool(one, worker_.work());
  run(pool, stops({"slow"}), in(20ms), [](const auto&) {});
  Reports next;
  run(pool, stops({"a"}), soon(), next.listener());
  EXPECT_TRUE(next.at(0));
  worker_.release();
}

TEST(BatchOutcomes, DropsWhatIsKnownAlreadyAndWhatWasNeverAsked) {
  Reports reported;
  BatchOutcomes outcomes(stops({"a", "b"}), reported.listener());
  outcomes.add({{7, {}}, {1, {}}, {1, fail(ErrorCode::Internal, "again")}});
  EXPECT_EQ(reported.count(), 1U);
  EXPECT_TRUE(reported.at(1));
  outcomes.note({0, fail(ErrorCode::HookFailed, "bad")});
  EXPECT_EQ(reported.count(), 2U) << "the last one is reported at once";
  outcomes.fail_rest([](std::size_t) { return fail(ErrorCode::Internal, "late"); });
  EXPECT_EQ(reported.calls(), 2U);
}

TEST(BatchOutcomes, SaysWhichActionFailedWhereTheErrorDoesNot) {
  Reports reported;
  BatchOutcomes outcomes(stops({"a", "b"}), reported.listener());
  outcomes.note({0, fail(ErrorCode::HookFailed, "bad", "motor")});
  outcomes.fail_rest(fail(ErrorCode::Unavailable, "gone"));
  EXPECT_EQ(reported.at(0).error().subject, "motor");
  EXPECT_EQ(reported.at(1).error().subject, "stop b");
}

/// The first action ends while the watch looks at its batch for the first time.
TEST(ActionPool, ReportsWhatEndsWhileTheWatchLooksAtTheBatch) {
  constexpr auto kPatience = 100us;
  constexpr int kTries = 1500;
  concurrent::ThreadPool threads("test", kActionThreads);
  for (int i = 0; i < kTries; ++i) {
    const Duration brief = kPatience + i % 150 * 2us;
    Worker worker;
    Reports reported;
    ActionPool pool(
        threads,
        [work = worker.work(), brief](const model::Action& action, TimePoint deadline) {
          const TimePoint end = monotonic_now() + brief;
          while (action.task()->str() == "brief" && monotonic_now() < end)
            std::this_thread::yield();
          return work(action, deadline);
        },
        kPatience);
    pool.begin(stops({"brief", "slow"}), soon(), reported.listener());
    const bool told = reported.wait_for(1);
    worker.release();
    ASSERT_TRUE(told) << "while the slow one is still at it; took " << brief.count() << " ns";
    ASSERT_TRUE(reported.wait_for(2));
  }
}

TEST(ActionPool, TellsHowLongEachActionTookByItself) {
  constexpr auto kLong = 5ms;
  concurrent::ThreadPool threads("test", kActionThreads);
  ActionPool pool(threads, [&](const model::Action& action, TimePoint) -> Result<void> {
    const TimePoint begin = RealClock::instance().now();
    while (action.task()->str() == "long" && RealClock::instance().now() < begin + kLong)
      std::this_thread::yield();
    return {};
  });
  const std::vector<model::Action> actions = {on_task(model::ActionKind::Stop, "quick"),
                                              on_task(model::ActionKind::Stop, "long"),
                                              on_task(model::ActionKind::Stop, "late")};
  std::map<std::size_t, Duration> took;
  const TimePoint begin = RealClock::instance().now();
  run(pool, actions, soon(), [&](const std::vector<Completed>& ended) {
    for (const auto& one : ended)
      took.emplace(one.index, one.took.value_or(Duration::max()));
  });
  const Duration all = RealClock::instance().now() - begin;
  ASSERT_THAT(took, SizeIs(3));
  EXPECT_GE(took.at(1), kLong);
  EXPECT_LE(took.at(0), all - kLong) << "not what others of its batch took";
  EXPECT_LE(took.at(2), all);
}

}  // namespace
}  // namespace segue::task_host

// SPDX-License-Identifier: Apache-2.0
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/question.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/runtime/served_runtime.hpp>

#include <support/eventually.hpp>
#include <support/forwarding_host.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <future>
#include <list>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "test_support.hpp"

namespace segue::runtime {
namespace {

using namespace std::chrono_literals;
using segue::testing::eventually;
using ::testing::HasSubstr;
using ::testing::Not;

const char* const kDrivingBesidePools = "network: drive\ntasks: {a: {component: \"x::A\"}}\n";

RuntimeOptions with_range(const std::string& size, const std::string& more = "") {
  Diagnostics diagnostics;
  const auto robot = model::read_robot(
      "robot: r\npools: {planner: {component: \"x::Planner\", size: " + size + more + "}}\n", "robot.yaml",
      diagnostics);
  EXPECT_TRUE(robot) << to_string(diagnostics);
  RuntimeOptions options;
  options.policies.restart = {.max = 2, .backoff = 1ms};
  options.policies.watch = 5ms;
  if (robot) options.pools = robot->pools;
  return options;
}

/// Operations of its tasks last until the test says so.
class WorkingHost final : public segue::testing::ForwardingHost {
 public:
  using ForwardingHost::ForwardingHost;
  Result<type::Value> call(const model::TaskId& task, std::string_view /*operation*/,
                           const type::Value& /*arguments*/, TimePoint /*deadline*/) override {
    Lock lock(mutex_);
    done_.wait(mutex_, [this] { return is_done_; });
    return type::Value(task.str());
  }
  void let_work_end() {
    const Lock lock(mutex_);
    is_done_ = true;
    done_.notify_all();
  }

 private:
  Mutex mutex_;  ///< protects the next two
  ConditionVariable done_;
  bool is_done_ = false;
};

class PoolsOnDemand : public ::testing::Test {
 protected:
  ~PoolsOnDemand() override {
    working_.let_work_end();
    callers_.clear();
  }
  void start(RuntimeOptions options) { runtime_.emplace("robot", working_, catalog_, std::move(options)); }
  Result<model::TakenInstance> take(const std::stop_token& stop = {}) {
    return answer_to<model::TakenInstance>(
        Wait(RealClock::instance().now() + 60s, stop), [&](const Wait& wait, model::InstanceAnswer answer) {
          runtime_->served().take_instance({"planner"}, wait, std::move(answer));
        });
  }
  /// A caller that takes an instance and calls it; its result names the instance.
  std::future<std::string> call() {
    std::packaged_task<std::string()> work([this] {
      const auto taken = take();
      if (!taken) return to_string(taken.error());
      const auto answer = runtime_->call(model::TaskId(taken->task), "plan", {}, Wait(TimePoint::max()));
      return answer ? answer->as_string() : to_string(answer.error());
    });
    auto result = work.get_future();
    callers_.emplace_back(std::move(work));
    return result;
  }
  /// Has so many instances made, by as many callers whose calls have ended.
  void grow_to(std::size_t count) {
    start(with_range("1..3", ", idle_after: 1h"));
    std::list<std::future<std::string>> results;
    for (std::size_t i = 0; i < count; ++i)
      results.push_back(call());
    ASSERT_TRUE(eventually([&] { return are_busy(count); }));
    working_.let_work_end();
    for (auto& result : results)
      result.wait();
  }
  PoolReport pool() { return runtime_->pools().at(0); }
  bool are_busy(std::size_t count) {
    const auto now = pool();
    return now.instances.size() == count && std::ranges::all_of(now.instances, &PoolInstance::busy);
  }
  bool are_ready(std::size_t count) {
    const auto now = pool();
    return now.instances.size() == count && std::ranges::all_of(now.instances, &PoolInstance::ready);
  }
  /// No process or task of an instance that is not needed is there.
  bool have_left(std::size_t count) { return are_ready(count) && host_.tasks().size() == count; }

  model::ComponentCatalog catalog_;
  task_host::LibrarySet libraries_;
  task_host::LocalTaskHost host_{
      libraries_, catalog_, {.stand_in = true, .only_stand_ins = false, .stand_ins = {}}};
  testing::AskingHost asking_{host_};
  WorkingHost working_{asking_};
  std::optional<Runtime> runtime_;
  std::list<std::jthread> callers_;
};

TEST_F(PoolsOnDemand, GrowWhileCallersWaitAndShrinkAfterwards) {
  start(with_range("1..3", ", idle_after: 20ms"));
  std::list<std::future<std::string>> results;
  for (int i = 0; i < 3; ++i)
    results.push_back(call());
  ASSERT_TRUE(eventually([&] { return are_busy(3); }));
  results.push_back(call());
  ASSERT_TRUE(eventually([&] { return pool().waiting == 1; })) << "for there can be no more";
  EXPECT_EQ(pool().least, 1);
  EXPECT_EQ(pool().most, 3);
  working_.let_work_end();
  for (auto& result : results)
    EXPECT_THAT(result.get(), HasSubstr("planner_"));
  EXPECT_TRUE(eventually([&] { return have_left(1); }));
  EXPECT_EQ(pool().waiting, 0);
  for (const auto& result : runtime_->history())
    EXPECT_EQ(result.cause, Cause::Pool) << result.why();
}

TEST_F(PoolsOnDemand, HaveNoInstanceBeforeTheFirstDemandWhereTheyNeedNone) {
  start(with_range("0..1", ", idle_after: 20ms"));
  EXPECT_EQ(runtime_->switch_to(testing::network_of(kDrivingBesidePools)).outcome, Outcome::Done);
  EXPECT_EQ(host_.tasks().size(), 1U);
  EXPECT_EQ(runtime_->snapshot().health.state, Health::State::Healthy);
  auto result = call();
  working_.let_work_end();
  EXPECT_EQ(result.get(), "planner_1");
  EXPECT_TRUE(eventually([&] { return pool().instances.empty(); }));
}

TEST_F(PoolsOnDemand, ForgetCallersWhoWaitNoLonger) {
  start(with_range("1..2"));
  auto first = call();
  ASSERT_TRUE(eventually([&] { return are_busy(1); }));
  asking_.ask([&](const model::Action& action) -> Result<void> {
    return action.label().find("planner_2") == std::string::npos
               ? Result<void>()
               : Result<void>(fail(ErrorCode::ResourceExhausted, "no process"));
  });
  std::stop_source stop;
  auto waits = std::async(std::launch::async, [&] { return take(stop.get_token()); });
  ASSERT_TRUE(eventually([&] { return pool().waiting == 1 && pool().instances.size() == 2; }));
  stop.request_stop();
  EXPECT_EQ(waits.get().error().code, ErrorCode::Cancelled);
  EXPECT_TRUE(eventually([&] { return pool().waiting == 0; }));
}

TEST_F(PoolsOnDemand, GiveCallersAnInstanceThatBecomesFreeWhereNoneCanBeMade) {
  asking_.ask([&](const model::Action& action) -> Result<void> {
    return action.label() == "start planner_2" ? Result<void>(fail(ErrorCode::HookFailed, "cannot"))
                                               : Result<void>();
  });
  start(with_range("1..2"));
  auto first = call();
  ASSERT_TRUE(eventually([&] { return are_busy(1); }));
  auto second = call();
  ASSERT_TRUE(eventually([&] {
    const auto now = pool();
    return now.instances.size() == 2 && now.instances[1].given_up;
  }));
  working_.let_work_end();
  EXPECT_EQ(first.get(), "planner_1");
  EXPECT_EQ(second.get(), "planner_1");
}

TEST_F(PoolsOnDemand, KeepToTheBudget) {
  RuntimeOptions options = with_range("1..3");
  options.pool_budget.processes = 1;
  start(std::move(options));
  std::list<std::future<std::string>> results;
  for (int i = 0; i < 3; ++i)
    results.push_back(call());
  ASSERT_TRUE(eventually([&] { return are_busy(2) && !pool().held_back.empty(); }));
  EXPECT_THAT(pool().held_back, HasSubstr("'pool_budget' permits 1"));
  working_.let_work_end();
  for (auto& result : results)
    EXPECT_THAT(result.get(), HasSubstr("planner_"));
}

TEST_F(PoolsOnDemand, AreNoPartOfASwitchAndHoldNoneUp) {
  start(with_range("1..2", ", idle_after: 20ms"));
  auto first = call();
  ASSERT_TRUE(eventually([&] { return are_busy(1); }));
  std::promise<void> is_made;
  std::promise<void> may_end;
  std::atomic<bool> is_first = true;
  std::atomic<bool> held_up = false;
  asking_.ask_after([&](const model::Action& action) -> Result<void> {
    if (action.label() != "configure planner_2" || !is_first.exchange(false)) return {};
    is_made.set_value();
    held_up = may_end.get_future().wait_for(20s) == std::future_status::timeout;
    return {};
  });
  auto second = call();
  is_made.get_future().wait();
  const auto result = runtime_->switch_to(testing::network_of(kDrivingBesidePools));
  EXPECT_EQ(result.outcome, Outcome::Done) << "while an instance is being made; " << result.why();
  may_end.set_value();
  for (const auto& record : result.actions)
    EXPECT_THAT(record.action.label(), Not(HasSubstr("planner")));
  EXPECT_TRUE(eventually([&] { return are_busy(2); })) << "the caller waits for it still";
  working_.let_work_end();
  EXPECT_EQ(second.get(), "planner_2");
  EXPECT_FALSE(held_up) << "the switch waited for the instance";
  EXPECT_TRUE(eventually([&] { return are_ready(1) && host_.tasks().size() == 2; }));
  EXPECT_EQ(runtime_->belief().name.str(), "drive");
}

TEST_F(PoolsOnDemand, LeaveNothingWhereTheyAreTakenDownWhileTheyGrow) {
  ASSERT_NO_FATAL_FAILURE(grow_to(2));
  ASSERT_EQ(runtime_->take_down().get().outcome, Outcome::Done);
  EXPECT_TRUE(host_.tasks().empty());
  EXPECT_EQ(runtime_->switch_to(testing::network_of(kDrivingBesidePools)).outcome, Outcome::Done);
  EXPECT_TRUE(eventually([&] { return are_ready(1) && host_.tasks().size() == 2; }))
      << "they begin with their least number";
}

TEST_F(PoolsOnDemand, AreTakenOverFromAnEarlierRuntimeWithTheirLeastNumber) {
  ASSERT_NO_FATAL_FAILURE(grow_to(3));
  EXPECT_EQ(host_.tasks().size(), 3U);
  callers_.clear();
  runtime_.reset();
  EXPECT_EQ(host_.tasks().size(), 3U);
  start(with_range("1..3", ", idle_after: 1h"));
  EXPECT_TRUE(eventually([&] { return have_left(1); }));
}

}  // namespace
}  // namespace segue::runtime

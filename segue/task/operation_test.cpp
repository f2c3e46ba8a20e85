// SPDX-License-Identifier: Apache-2.0
#include <segue/base/virtual_clock.hpp>
#include <segue/task/call_queue.hpp>
#include <segue/task/probe_component.hpp>

#include <support/eventually.hpp>

#include <gmock/gmock.h>

#include <latch>
#include <thread>

namespace segue::task {
namespace {

using namespace std::chrono_literals;
using test::soon;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using type::Value;

class Calculator : public test::Probe {
 public:
  std::latch inside{1};
  std::latch go_on{1};
  std::thread::id ran_in;

  Operation<double(double, double)> divide{*this, "divide", {"a", "b"}, [this](double a, double b) {
                                             ran_in = std::this_thread::get_id();
                                             if (b == 0) throw std::domain_error("division by zero");
                                             return a / b;
                                           }};
  Operation<double(double)> twice{*this,
                                  "twice",
                                  {"x"},
                                  [this](double x) {
                                    ran_in = std::this_thread::get_id();
                                    return 2 * x;
                                  },
                                  RunsIn::CallerThread};
  Operation<Result<int>(const std::string&)> parse{
      *this, "parse", {"text"}, [](const std::string& text) -> Result<int> {
        if (text.empty()) return fail(ErrorCode::ParseError, "nothing to parse");
        return static_cast<int>(text.size());
      }};
  Operation<void()> wait{*this, "wait", {}, [this] {
                           inside.count_down();
                           go_on.wait();
                         }};
  Operation<void()> explode{*this, "explode", {}, [this] { exception("boom"); }};
};

using Name = const char*;
static_assert(std::is_constructible_v<ArgumentNames<2>, Name, Name>);
static_assert(!std::is_constructible_v<ArgumentNames<2>, Name>, "an argument has no name");
static_assert(!std::is_constructible_v<ArgumentNames<2>, Name, Name, Name>, "a name has no argument");

class Operations : public ::testing::Test {
 protected:
  Operations() {
    auto component = std::make_unique<Calculator>();
    calculator = component.get();
    auto made = Task::create("calc", std::move(component));
    EXPECT_TRUE(made);
    task = std::move(*made);
  }
  std::unique_ptr<Task> task;
  Calculator* calculator = nullptr;
};

TEST_F(Operations, RunInTheTasksThreadByNameOrInOrderInAnyState) {
  auto by_name = task->call("divide", Value::map({{"b", 4}, {"a", 10}}), soon());
  ASSERT_TRUE(by_name) << to_string(by_name.error());
  EXPECT_EQ(*by_name, Value(2.5));
  EXPECT_NE(calculator->ran_in, std::this_thread::get_id());
  ASSERT_TRUE(task->configure(soon()));
  EXPECT_EQ(*task->call("divide", Value::list({9, 3}), soon()), Value(3.0));
  ASSERT_TRUE(task->start(soon()));
  EXPECT_EQ(*task->call("divide", Value::list({8, 2}), soon()), Value(4.0));
}

TEST_F(Operations, RunInTheCallersThreadWhereDeclaredSo) {
  EXPECT_EQ(*task->call("twice", Value::list({21}), soon()), Value(42.0));
  EXPECT_EQ(calculator->ran_in, std::this_thread::get_id());
}

TEST_F(Operations, ExceptionBecomesAnErrorAndTheTaskLivesOn) {
  auto result = task->call("divide", Value::list({1, 0}), soon());
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::HookFailed);
  EXPECT_THAT(result.error().message, HasSubstr("division by zero"));
  EXPECT_EQ(*task->call("divide", Value::list({1, 1}), soon()), Value(1.0));
}

TEST_F(Operations, ResultOfAFunctionThatMayFailIsPassedOn) {
  EXPECT_EQ(*task->call("parse", Value::list({"four"}), soon()), Value(4));
  auto failed = task->call("parse", Value::list({""}), soon());
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().code, ErrorCode::ParseError);
}

TEST_F(Operations, WrongArgumentsAreRefusedWithTheSignature) {
  const auto refusal = [&](std::string_view name, const Value& arguments) {
    auto result = task->call(name, arguments, soon());
    return result ? std::string("accepted") : result.error().message;
  };
  EXPECT_THAT(refusal("divide", Value::list({1})), HasSubstr("divide(a: /double, b: /double): expected 2"));
  EXPECT_THAT(refusal("divide", Value::map({{"a", 1}})), HasSubstr("argument 'b' is missing"));
  EXPECT_THAT(refusal("divide", Value::map({{"a", 1}, {"b", 1}, {"c", 1}})), HasSubstr("no argument 'c'"));
  EXPECT_THAT(refusal("divide", Value::list({1, "x"})), HasSubstr("divide.b"));
  EXPECT_THAT(refusal("divide", Value(3)), HasSubstr("map or a list"));
  EXPECT_THAT(refusal("divid", Value()), HasSubstr("did you mean 'divide'"));
}

TEST_F(Operations, CallThatDidNotBeginInTimeNeverRuns) {
  std::thread blocker([&] { EXPECT_TRUE(task->call("wait", Value(), soon())); });
  calculator->inside.wait();
  auto late = task->call("divide", Value::list({1, 1}), RealClock::instance().now() + 1ms);
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().code, ErrorCode::DeadlineExceeded);
  EXPECT_THAT(late.error().message, HasSubstr("did not begin"));
  calculator->go_on.count_down();
  blocker.join();
  EXPECT_EQ(*task->call("twice", Value::list({1}), soon()), Value(2.0));
  EXPECT_TRUE(task->configure(soon()));
  task.reset();
}

TEST_F(Operations, CallThatDoesNotEndInTimeIsLeftAlone) {
  auto unfinished = task->call("wait", Value(), RealClock::instance().now() + 1ms);
  ASSERT_FALSE(unfinished);
  EXPECT_EQ(unfinished.error().code, ErrorCode::DeadlineExceeded);
  calculator->go_on.count_down();
  EXPECT_EQ(*task->call("divide", Value::list({6, 3}), soon()), Value(2.0));
}

TEST_F(Operations, OneThatExceedsTheDeadlinesOfItsCallAndItsTaskIsOverdue) {
  Activity activity{.trigger = Trigger::PortDriven, .update_deadline = 1ns};
  auto component = std::make_unique<Calculator>();
  Calculator& slow = *component;
  task = std::move(*Task::create("slow", std::move(component), &activity));
  std::thread patient([&] { EXPECT_TRUE(task->call("wait", Value(), soon())); });
  slow.inside.wait();
  EXPECT_FALSE(task->overdue()) << "its caller waits for it";
  slow.go_on.count_down();
  patient.join();

  activity.update_deadline = 1ms;
  component = std::make_unique<Calculator>();
  Calculator& stuck = *component;
  task = std::move(*Task::create("stuck", std::move(component), &activity));
  while (!stuck.inside.try_wait())  // a call that did not begin in time never runs
    ASSERT_FALSE(task->call("wait", Value(), RealClock::instance().now() + 20ms));
  ASSERT_TRUE(segue::testing::eventually([&] { return task->overdue().has_value(); }));
  EXPECT_EQ(task->overdue(), "an operation has not returned within 1ms");
  EXPECT_THAT(to_string(task->configure(soon()).error()), HasSubstr("an operation has not returned"));
  stuck.go_on.count_down();
  EXPECT_TRUE(task->call("divide", Value::list({6, 3}), soon()));
  EXPECT_FALSE(task->overdue());
}

TEST_F(Operations, OwnHookMayCallThemDirectly) {
  Result<Value> result;
  calculator->act = [&](const std::string&) -> Result<void> {
    result = task->call("divide", Value::list({6, 3}), soon());
    return {};
  };
  ASSERT_TRUE(task->configure(soon()));
  calculator->act = [](const std::string&) -> Result<void> { return {}; };
  EXPECT_EQ(*result, Value(2.0));
  EXPECT_EQ(calculator->ran_in, std::this_thread::get_id());
}

TEST_F(Operations, AskingForExceptionUndoesTheTask) {
  ASSERT_TRUE(task->configure(soon()));
  ASSERT_TRUE(task->start(soon()));
  calculator->hooks.clear();
  ASSERT_TRUE(task->call("explode", Value(), soon()));
  // The change takes effect after the call; the next call sees it.
  ASSERT_TRUE(task->call("divide", Value::list({1, 1}), soon()));
  EXPECT_EQ(task->state(), TaskState::Exception);
  EXPECT_THAT(calculator->hooks, ElementsAre("stop", "cleanup"));
}

TEST_F(Operations, WaitingCallIsCancelledWhenTheTaskGoes) {
  VirtualClock clock;
  auto executor = std::make_shared<ManualExecutor>(clock);
  auto made = Task::create("never_run", std::make_unique<Calculator>(), Activity{}, executor);
  ASSERT_TRUE(made);
  Task& never_run = **made;
  std::thread caller([&] {
    // Whether the task is destroyed before or during the wait, the call returns and nothing dangles.
    auto result = never_run.call("divide", Value::list({1, 1}), RealClock::instance().now() + 50ms);
    EXPECT_FALSE(result);
  });
  caller.join();
  made->reset();
}

TEST_F(Operations, ManyCallersAreServedInTurn) {
  ASSERT_TRUE(task->configure(soon()));
  std::vector<std::thread> callers;
  for (int i = 0; i < 4; ++i) {
    callers.emplace_back([&, i] {
      for (int j = 1; j < 50; ++j) {
        auto result = task->call("divide", Value::list({i * j, j}), soon());
        ASSERT_TRUE(result);
        ASSERT_EQ(*result, Value(i));
      }
    });
  }
  for (std::thread& caller : callers)
    caller.join();
}

TEST(CallQueue, ACallThatIsRefusedTakesNoPlace) {
  detail::CallQueue queue;
  const auto call = std::make_shared<detail::PendingCall>(nullptr, "f", TimePoint::max());
  const auto fill = [&] {
    for (int i = 0; i < detail::CallQueue::kLimit; ++i)
      ASSERT_TRUE(queue.push(call)) << i;
    EXPECT_FALSE(queue.push(call));
  };
  fill();
  queue.take_all([](detail::PendingCall&) {});
  fill();
}

TEST_F(Operations, DynamicOnesTakeValues) {
  struct Echo : test::Probe {
    DynamicOperation echo{
        *this,
        {"echo", {{"what", nullptr, ""}}, "", RunsIn::TaskThread, ""},
        [](const std::vector<Value>& arguments) -> Result<Value> { return arguments.at(0); }};
  };
  auto made = Task::create("echo", std::make_unique<Echo>());
  ASSERT_TRUE(made);
  EXPECT_EQ(*(*made)->call("echo", Value::map({{"what", "hello"}}), soon()), Value("hello"));
}

}  // namespace
}  // namespace segue::task
